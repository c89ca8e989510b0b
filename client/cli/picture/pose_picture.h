// One pose of a skeleton, drawn.
#ifndef CLIENT_CLI_PICTURE_POSE_PICTURE_H_
#define CLIENT_CLI_PICTURE_POSE_PICTURE_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

// Every link as a wedge: along its axis with its length where the joint says
// so, else to each child and end effector. `targets` are points to reach, m.
// From the front and from the side; a skeleton whose joints all lie in a plane
// across Z is seen along Z only. `positions` has size position_count.
std::string PosePictureSvg(const Skeleton& skeleton,
                           const Eigen::VectorXd& positions,
                           absl::Span<const Eigen::Vector3d> targets,
                           absl::string_view title);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_POSE_PICTURE_H_
