// A skin's vertices at many poses, as the service answers them.
#ifndef CLIENT_CLI_SKIN_DEFORMED_FRAMES_H_
#define CLIENT_CLI_SKIN_DEFORMED_FRAMES_H_

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/client/connection.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::cli {

struct DeformedFrame {
  // In the order of the vertices, world frame, m; none of control planes, which
  // the client would have to deform itself.
  std::vector<Eigen::Vector3d> positions;
  int64_t byte_size = 0;
  bool is_keyframe = false;
  int fold_count = 0;
  int clamped_count = 0;
};

struct DeformedFrames {
  std::vector<Triangle> triangles;
  std::vector<DeformedFrame> frames;
};

// Asks in as many calls as the service's bound on poses wants.
absl::StatusOr<DeformedFrames> DeformSkin(
    client::Connection& connection, const std::string& skin,
    const std::vector<v1::SkinPose>& poses, v1::VertexEncoding encoding);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_DEFORMED_FRAMES_H_
