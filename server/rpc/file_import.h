// A file's bytes in, what the store keeps out, whatever the format.
#ifndef GELENK_SERVER_RPC_FILE_IMPORT_H_
#define GELENK_SERVER_RPC_FILE_IMPORT_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gelenk/v1/kinematics_service.pb.h"
#include "server/options.h"
#include "server/store/skeleton_store.h"

namespace gelenk::server {

struct FileImport {
  // Without name, create time and trees.
  StoredSkeleton skeleton;
  // Metres per unit of the file, as given or inferred.
  double unit_m = 0;
};

// INVALID_ARGUMENT naming "header.format" or "header.unit_m"; OK for what
// ImportFile can read.
absl::Status CheckImportFormat(const v1::ImportHeader& header);

// Errors: those of the format's reader. `header` is checked.
absl::StatusOr<FileImport> ImportFile(const v1::ImportHeader& header,
                                      std::string bytes, const Limits& limits);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_FILE_IMPORT_H_
