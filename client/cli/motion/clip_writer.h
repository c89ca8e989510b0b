// Motion as files.
#ifndef CLIENT_CLI_MOTION_CLIP_WRITER_H_
#define CLIENT_CLI_MOTION_CLIP_WRITER_H_

#include <string>

#include "absl/status/status.h"
#include "client/cli/bvh_clip.h"
#include "gelenk/motion/motion_clip.h"

namespace gelenk::cli {

// By the name's end: .bvh, .gltf or .glb. A BVH of the skeleton of `form` (may
// be null) keeps its form.
absl::Status WriteClip(const MotionClip& clip, const BvhClip* form,
                       const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_CLIP_WRITER_H_
