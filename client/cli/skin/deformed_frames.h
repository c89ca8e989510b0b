// A skin's vertices at many poses, as the service answers them.
#ifndef CLIENT_CLI_SKIN_DEFORMED_FRAMES_H_
#define CLIENT_CLI_SKIN_DEFORMED_FRAMES_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/client/connection.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::cli {

// What happened to the volumes of a link over all frames.
struct LinkTrouble {
  // Frames in which a volume of it folds, and the worst of them.
  int fold_count = 0;
  int worst_fold_frame = 0;
  double least_jacobian = 0;
  // Frames in which a muscle of it wanted more than it got.
  int clamp_count = 0;
};

struct DeformedFrames {
  std::vector<Triangle> triangles;
  int keyframe_count = 0;
  int64_t bytes = 0;
  int64_t most_bytes = 0;
  // Frame by frame, how many volumes fold; and frames with clamped muscles.
  std::vector<int> folds;
  int clamp_count = 0;
  std::map<std::string, LinkTrouble> links;
  // Of the frames that were asked for, by their indices; in the order of the
  // vertices, world frame, m.
  std::map<size_t, std::vector<Eigen::Vector3d>> positions;
};

// Asks in as many calls as the service's bound on poses wants, and keeps the
// vertices of the frames of `kept`.
absl::StatusOr<DeformedFrames> DeformSkin(
    client::Connection& connection, const std::string& skin,
    const std::vector<v1::SkinPose>& poses, v1::VertexEncoding encoding,
    const std::set<size_t>& kept);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_DEFORMED_FRAMES_H_
