// The links of a layered skin: which bones carry volumes, and how they hang
// together.
//
// A link runs from a joint to the next one: its child, an end effector, or as
// far as the joint says. Joints at one place (the axes of an Euler joint) carry
// one link, by the last of them. Link frame: origin at the joint, x along the
// link; s and t of its sections are y and z. Where a joint has several
// children, one continues the link, every other is a branch.
//
// Errors: INVALID_ARGUMENT that lists every malformed override.
// Cost: linear in the joints.
#ifndef GELENK_SKIN_SKIN_LINK_H_
#define GELENK_SKIN_SKIN_LINK_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct SkinLink {
  // Of the joint that carries it.
  std::string id;
  int joint = -1;
  // Indices of links; parents come first. -1 for none.
  int parent = -1;
  // The link that starts where this one ends and shares its last plane.
  int continuation = -1;
  RigidTransform joint_from_link;
  double length_m = 0;
  // Half axes of the section's ellipse along s and t: how far the volume
  // reaches.
  Eigen::Vector2d half_extents_m = Eigen::Vector2d::Zero();
  // How far the rigid caps hold vertices, before the start of a chain and
  // beyond its end.
  Eigen::Vector2d cap_reach_m = Eigen::Vector2d::Zero();
};

// What to do otherwise than the rest pose suggests, for one joint.
struct SkinLinkOverride {
  std::string joint_id;
  // No link here; its children hang from the link before.
  bool omit = false;
  std::optional<double> length_m;
  // Along the link, joint frame, any length but zero.
  std::optional<Eigen::Vector3d> direction;
  // Of the section, joint frame; its part across the link counts.
  std::optional<Eigen::Vector3d> s_direction;
  std::optional<Eigen::Vector2d> half_extents_m;
  // The joint whose link continues this one; empty: none does, all are
  // branches.
  std::optional<std::string> continuation_joint_id;
};

struct SkinLinkOptions {
  // The pose at which the skin is bound; empty means the skeleton's rest pose.
  Eigen::VectorXd rest_positions;
  // Half extents of a link of length 1 when nobody says otherwise.
  double slenderness = 0.2;
  std::vector<SkinLinkOverride> overrides;
};

// A body with fingers and face has about 150 links; each takes 19 planes' worth
// of memory a frame.
inline constexpr int kMaxSkinLinks = 1024;

absl::StatusOr<std::vector<SkinLink>> DeriveSkinLinks(
    const Skeleton& skeleton, const SkinLinkOptions& options = {});

// The rest pose that `options` mean.
Eigen::VectorXd RestPositionsOf(const Skeleton& skeleton,
                                const SkinLinkOptions& options);

}  // namespace gelenk

#endif  // GELENK_SKIN_SKIN_LINK_H_
