// A file's bytes in, a clip out, whatever the format.
#ifndef GELENK_SERVER_RPC_CLIP_IMPORT_H_
#define GELENK_SERVER_RPC_CLIP_IMPORT_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/v1/motion_service.pb.h"
#include "server/options.h"
#include "server/store/clip_store.h"

namespace gelenk::server {

struct ClipImport {
  // Of a skeleton of its own.
  MotionClip clip;
  // Null but for BVH.
  std::shared_ptr<const BvhForm> form;
  // Metres per unit of the file, as given or inferred.
  double unit_m = 0;
  std::vector<std::string> warnings;
};

// INVALID_ARGUMENT naming what of `file` is wrong: format, unit, animation; or
// as the format's reader.
absl::StatusOr<ClipImport> ImportClip(const v1::ClipFile& file,
                                      const Limits& limits);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_CLIP_IMPORT_H_
