// Serial chains as Denavit-Hartenberg tables, both ways and in both conventions
// (Denavit and Hartenberg, 1955; Craig, Introduction to Robotics, ch. 3).
//
//   standard (distal):    Rz(theta) Tz(d) Tx(a) Rx(alpha)
//   modified (proximal):  Rx(alpha) Tx(a) Tz(d) Rz(theta)
//
// q of a revolute row is added to its theta, q of a prismatic row to its d; a
// fixed row has no q. m, rad.
//
// From geometry to parameters: the joints' axes are lines in space, and each
// frame stands where the common perpendicular of its axis and the next one
// meets it, x along that perpendicular. Where that is not unique:
//   intersecting axes   a = 0, x along the cross product of the axes;
//   parallel axes       the perpendicular through the frame before, so d = 0;
//   coincident axes     the frame before, so a = d = theta = 0.
// The first row's free numbers are 0: the base frame takes them up, and the
// tool frame what is behind the last axis. Axes count as parallel below
// kParallel; between that and about 1e-4 the perpendicular is far away and
// digits are lost, which is the parameters' own weakness.
#ifndef GELENK_KINEMATICS_DH_TABLE_H_
#define GELENK_KINEMATICS_DH_TABLE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/joint.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {

// Sine of the angle between axes that count as parallel.
inline constexpr double kParallel = 1e-9;

enum class DhConvention { kStandard, kModified };

struct DhRow {
  double a_m = 0;
  double alpha_rad = 0;
  double d_m = 0;
  double theta_rad = 0;
  // Revolute, prismatic or fixed.
  JointType type = JointType::kRevolute;
  // Of q.
  JointLimits limits;
};

struct DhTable {
  DhConvention convention = DhConvention::kStandard;
  // Base to tip.
  std::vector<DhRow> rows;
  RigidTransform world_from_base;
  RigidTransform last_from_tool;
};

// A builder with one joint a row, "j0", "j1", .., moving about or along its own
// z, and the end effector "tip". INVALID_ARGUMENT naming the bad fields of the
// table.
absl::StatusOr<SkeletonBuilder> BuilderOf(const DhTable& table);

// The chain from `base_joint_id` (empty: the root) to an end effector or joint.
// One row a revolute or prismatic joint, with the same q; fixed joints go into
// the numbers of the others. `world_from_base` of the table is where the base
// joint is while all joints above it are at q = 0. INVALID_ARGUMENT naming
// "end_effector_id" or "base_joint_id" when there is none, the one is not above
// the other, a joint between them is of another type or mimics, or none moves.
absl::StatusOr<DhTable> ToDhTable(const Skeleton& skeleton,
                                  absl::string_view base_joint_id,
                                  absl::string_view end_effector_id,
                                  DhConvention convention);

}  // namespace gelenk

#endif  // GELENK_KINEMATICS_DH_TABLE_H_
