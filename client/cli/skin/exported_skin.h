// A skin as a glTF file, from the service.
#ifndef CLIENT_CLI_SKIN_EXPORTED_SKIN_H_
#define CLIENT_CLI_SKIN_EXPORTED_SKIN_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/client/connection.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::cli {

struct ExportedSkin {
  std::string glb;
  int inexact_vertex_count = 0;
};

// `poses` become an animation; the service takes 1024.
absl::StatusOr<ExportedSkin> ExportSkin(client::Connection& connection,
                                        const std::string& skin,
                                        const std::vector<v1::SkinPose>& poses,
                                        absl::Duration frame_time);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_EXPORTED_SKIN_H_
