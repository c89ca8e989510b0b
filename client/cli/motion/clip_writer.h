// Motion as files.
#ifndef CLIENT_CLI_MOTION_CLIP_WRITER_H_
#define CLIENT_CLI_MOTION_CLIP_WRITER_H_

#include <Eigen/Core>
#include <string>

#include "absl/status/status.h"
#include "client/cli/motion/body_file.h"

namespace gelenk::cli {

// By the name's end: .bvh, .gltf or .glb. `positions` are frames of the body's
// skeleton; a BVH of a skeleton that came from one keeps its form.
absl::Status WriteClip(const BodyFile& body, const Eigen::MatrixXd& positions,
                       double frame_time_s, const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_CLIP_WRITER_H_
