// A limb of two bones in space, in closed form: hip, knee, ankle; shoulder,
// elbow, wrist. The triangle of root, middle and tip is that of two links in
// the plane (two_link.h); a pole or a swivel angle turns its plane.
//
// Near full extension the distance r to the target is softened, so that the
// middle joint does not pop: within `soft_distance_m` = s of the full length L,
//   r' = (L - s) + s (1 - exp(-(r - (L - s)) / s)),
// continuous with its first derivative; the tip then stays r - r' short of the
// target, which the answer tells. Stretch makes both bones longer by one factor
// to close that gap, as far as it is allowed. World frame, m. Allocates
// nothing.
#ifndef GELENK_IK_TWO_BONE_H_
#define GELENK_IK_TWO_BONE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "absl/status/status.h"

namespace gelenk {

struct TwoBoneProblem {
  // Where the joints are at rest.
  Eigen::Vector3d world_root = Eigen::Vector3d::Zero();
  Eigen::Vector3d world_mid = Eigen::Vector3d::Zero();
  Eigen::Vector3d world_tip = Eigen::Vector3d::Zero();
  Eigen::Vector3d world_target = Eigen::Vector3d::Zero();
  // The middle joint bends towards this point. A pole on the line from root to
  // target says nothing: then the bend of the rest pose is kept.
  std::optional<Eigen::Vector3d> world_pole;
  // Without a pole: turns the bend about the axis from root to target, from
  // where the shortest rotation carries that of the rest pose, rad.
  double swivel_rad = 0;
  // 0 is off.
  double soft_distance_m = 0;
  // 1 is off.
  double max_stretch = 1;
};

struct TwoBoneSolution {
  // Turns of the bones from their rest; the plane of the limb turns along.
  Eigen::Quaterniond world_root_rotation = Eigen::Quaterniond::Identity();
  Eigen::Quaterniond world_mid_rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d world_mid = Eigen::Vector3d::Zero();
  Eigen::Vector3d world_tip = Eigen::Vector3d::Zero();
};

struct TwoBoneAnswer {
  // The bend that was asked for, then its mirror image; one where the limb is
  // straight or folded.
  std::array<TwoBoneSolution, 2> solutions;
  int solution_count = 0;
  // The target is outside min_reach_m .. max_reach_m, stretch counted.
  bool unreachable = false;
  // From the tip to the target, the soft gap included.
  double distance_m = 0;
  double min_reach_m = 0;
  double max_reach_m = 0;
  // Factor on both bones.
  double stretch = 1;
};

// INVALID_ARGUMENT naming every bad field: not finite, a bone without length,
// a negative soft distance or one as long as the limb, a stretch below 1.
absl::Status CheckTwoBone(const TwoBoneProblem& problem);

// `problem` has passed CheckTwoBone.
TwoBoneAnswer SolveTwoBone(const TwoBoneProblem& problem);

}  // namespace gelenk

#endif  // GELENK_IK_TWO_BONE_H_
