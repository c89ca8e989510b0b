// One node of a skeleton: a group of degrees of freedom and the link it moves.
//
// Units m, rad, kg; right-handed frames. The joint frame sits at
// `parent_from_joint` in the parent joint's frame while the joint is neutral;
// the joint's motion is composed on its right:
//   world_from_joint = world_from_parent * parent_from_joint * motion(q).
#ifndef GELENK_SKELETON_JOINT_H_
#define GELENK_SKELETON_JOINT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/joint_limits.h"

namespace gelenk {

enum class JointType {
  kFixed,      // q = []
  kRevolute,   // q = [angle about `axis`]
  kPrismatic,  // q = [displacement along `axis`]
  kSpherical,  // q = [x y z w]; velocity: body-frame rotation vector
  kPlanar,     // q = [u v angle]; see PlanarBasis
  kFree,       // q = [tx ty tz x y z w]; velocity: translation in the rest
               // frame, then body-frame rotation vector
};

// Numbers of q, and of a velocity, that a joint of `type` owns. A mimic joint
// owns none.
int PositionCount(JointType type);
int VelocityCount(JointType type);
absl::string_view JointTypeName(JointType type);

// True for the types whose motion needs `axis`.
bool NeedsAxis(JointType type);

// The frame in which a planar joint moves: columns u, v, axis, with u and v the
// images of X and Y under the shortest rotation from Z to `axis`.
Eigen::Matrix3d PlanarBasis(const Eigen::Vector3d& axis);

// q of this joint = multiplier * q of `joint_id` + offset; both revolute or
// prismatic.
struct Mimic {
  std::string joint_id;
  double multiplier = 1;
  double offset = 0;  // rad or m
};

struct Joint {
  // Unique in the skeleton, 1 to 63 bytes.
  std::string id;
  // Empty for the root.
  std::string parent_id;
  JointType type = JointType::kFixed;
  RigidTransform parent_from_joint;
  // Unit, joint frame. For spherical and free joints the twist axis of their
  // limits.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  JointLimits limits;
  std::optional<Mimic> mimic;
  // Relative cost of moving per degree of freedom; empty means 1 everywhere.
  std::vector<double> stiffness;
  // Length of the link drawn along `link_direction`; 0 means to the children.
  double link_length_m = 0;
  Eigen::Vector3d link_direction = Eigen::Vector3d::UnitX();
  double link_mass_kg = 0;
  // Joint frame, m.
  Eigen::Vector3d link_center_of_mass = Eigen::Vector3d::Zero();
};

// A named frame on a link: the tip of a chain, a palm, a sole.
struct EndEffector {
  std::string id;
  std::string joint_id;
  RigidTransform joint_from_end_effector;
};

}  // namespace gelenk

#endif  // GELENK_SKELETON_JOINT_H_
