// Chains of links in the XY plane: n angles, each against the link before it,
// and two coordinates more when the base may move.
//
// Nothing but a way to write joints: the skeleton is one like any other, with
// all axes along +Z. Branches are joints added to the builder.
#ifndef GELENK_SKELETON_PLANAR_CHAIN_H_
#define GELENK_SKELETON_PLANAR_CHAIN_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skeleton/joint_limits.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {

struct PlanarChain {
  // Base to tip, each > 0.
  std::vector<double> link_lengths_m;
  Eigen::Vector2d base = Eigen::Vector2d::Zero();
  // Two prismatic joints before the first angle, along X and along Y.
  bool movable_base = false;
  // One per angle, or none.
  std::vector<JointLimits> limits;
};

// A builder with joints "j0", "j1", .. ("base_x", "base_y" before them when the
// base moves) and the end effector "tip"; planar. INVALID_ARGUMENT naming
// "link_lengths", "base" and "limits" where they are malformed.
absl::StatusOr<SkeletonBuilder> BuilderOf(const PlanarChain& chain);

}  // namespace gelenk

#endif  // GELENK_SKELETON_PLANAR_CHAIN_H_
