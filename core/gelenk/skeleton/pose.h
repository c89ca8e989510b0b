// Arithmetic on the state vector q of a skeleton.
//
// q (size position_count) lives on a manifold: quaternions are unit. Velocities
// and differences (size velocity_count) live in its tangent space; see
// JointType for each joint's coordinates. All functions are linear in the
// joints and allocate nothing; sizes are the caller's duty except in
// CheckPositions.
#ifndef GELENK_SKELETON_POSE_H_
#define GELENK_SKELETON_POSE_H_

#include <Eigen/Core>

#include "absl/status/status.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// A non-owning view of q or of a velocity.
using ConstVectorView = Eigen::Ref<const Eigen::VectorXd>;
using VectorView = Eigen::Ref<Eigen::VectorXd>;

// All zeros and identities.
Eigen::VectorXd NeutralPositions(const Skeleton& skeleton);

// INVALID_ARGUMENT naming "positions[i]" when the size is wrong, a number is
// not finite or a quaternion is not near unit. Normalises those that are near
// (see NormalizeNearUnit); takes exact ones as they are.
absl::Status CheckPositions(const Skeleton& skeleton, VectorView positions);

// The same for the numbers at `offset` of one joint that owns them.
void CheckJointPositions(JointType type, int offset, VectorView positions,
                         Violations& violations);

// q moved by `velocity` for unit time: result = q [+] velocity. `result` may
// alias `positions`.
void Integrate(const Skeleton& skeleton, const ConstVectorView& positions,
               const ConstVectorView& velocity, VectorView result);

// The velocity that moves `from` to `to` in unit time: result = to [-] from.
void Difference(const Skeleton& skeleton, const ConstVectorView& from,
                const ConstVectorView& to, VectorView result);

// Moves each coordinate to the nearest one inside its limits, those of joints
// that mimic it included. Returns the largest move, rad or m; 0 when q was
// inside.
double ClampToLimits(const Skeleton& skeleton, VectorView positions);

// By how much q breaks its limits at worst, rad or m; 0 inside. `joint` (may be
// null) receives the joint that is worst, -1 inside.
double LimitExcess(const Skeleton& skeleton, const ConstVectorView& positions,
                   int* joint);

// The number that moves `joint`: its own, or by its mimic. Revolute and
// prismatic joints only.
double ScalarPosition(const Skeleton& skeleton,
                      const ConstVectorView& positions, int joint);

// Flips quaternions of `positions` into the hemispheres of `reference`.
void AlignHemispheres(const Skeleton& skeleton,
                      const ConstVectorView& reference, VectorView positions);

}  // namespace gelenk

#endif  // GELENK_SKELETON_POSE_H_
