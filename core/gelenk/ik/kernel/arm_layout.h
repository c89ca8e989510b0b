// An arm: a serial chain of a few joints with one degree of freedom each and
// one goal on its tip. What the kernels of arms work on; plain data, see
// tree_layout.h.
//
// Frames follow Denavit and Hartenberg as far as they save work: a joint's axis
// is the z of its frame and, once it has turned, x is perpendicular to this
// axis and the next. So what lies between two joints is a translation and a
// turn, the twist, about x. Origins stay where the skeleton has them: nothing
// runs off to infinity where axes are nearly parallel.
//
// How the last joint's frame lies to the tip is folded into the target: kernels
// compare the last frame with where it ought to be.
#ifndef GELENK_IK_KERNEL_ARM_LAYOUT_H_
#define GELENK_IK_KERNEL_ARM_LAYOUT_H_

#include <cstdint>

#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel {

// Arms have six or seven joints; a rail, a torso or a tool adds a few. All that
// a solve works on lies on the stack.
inline constexpr int kMaxArmJoints = 16;

// Per joint, and zeros after the last.
struct alignas(64) ArmRow {
  double values[kMaxArmJoints];

  double& operator[](int i) { return values[i]; }
  double operator[](int i) const { return values[i]; }
};

struct ArmLayout {
  ArmRow turn;    // 1 where the joint turns about its axis, 0 where it slides
  ArmRow offset;  // of the angle about the axis
  ArmRow cos_twist;
  ArmRow sin_twist;
  ArmRow x;  // the next joint's origin, or the tip, once this one has turned
  ArmRow y;
  ArmRow z;
  ArmRow ease;  // 1 / sqrt(stiffness)
  // The first joint's frame before it turns.
  Matrix3 base_from_first_rotation;
  Vector3 base_from_first_translation;
  Matrix3 last_from_tip_rotation;
  int joint_count;
  bool is_plain;  // all joints turn and have stiffness 1
};

// Where the last joint's frame, its origin moved to the tip, ought to be.
struct ArmTarget {
  Matrix3 world_rotation;
  Vector3 world_translation;
};

struct ArmSettings {
  Matrix3 world_from_first_rotation;
  Vector3 world_from_first_translation;
  // What this solve keeps to: the joints' limits or narrower. The start is
  // inside. Infinite after the last joint.
  ArmRow lower;
  ArmRow upper;
  // Square roots of the goal's weights, the largest of them 1; a masked axis
  // has 0, and so has a rotation that is free.
  double translation_scale[3];
  double rotation_scale;
  // 1 for an axis that counts for the error, 0 for a masked one.
  double translation_counts[3];
  bool is_plain;               // every scale is 1
  double position_tolerance2;  // m^2
  double rotation_tolerance2;  // (2 sin(angle / 2))^2
  int max_iterations;
  // As in Settings.
  bool (*stop)(const void* context);
  const void* stop_context;
};

// Of a pose; errors squared, rotation as (2 sin(angle / 2))^2.
struct ArmErrors {
  double energy;  // half the weighted squared error
  double position2;
  double rotation2;
};

struct ArmAttempt {
  AttemptEnd end;
  int iterations;
  int drawn;  // random starts that were used
  ArmErrors errors;
  bool pushed_at_limit;  // see Attempt
};

// Damped steps from `q`, for the shortest time to a target nearby. Gives up,
// kImpatient, where a few iterations do not reduce the error much; then and at
// the end of the iterations `q` is the best pose met.
using DescendArmFunction = ArmAttempt (*)(const ArmLayout& arm,
                                          const ArmSettings& settings,
                                          const ArmTarget& target, ArmRow& q);

// Newton's steps from `q`, none of which raises the error or moves a joint by
// more than `max_step`, to a pose from which no small step leads nearer
// (kStationary): slower, but sure, and quick also where the target is out of
// reach.
using SettleArmFunction = ArmAttempt (*)(const ArmLayout& arm,
                                         const ArmSettings& settings,
                                         double max_step,
                                         const ArmTarget& target, ArmRow& q);

// Where random starts come from.
struct ArmStarts {
  ArmRow lower;
  ArmRow upper;
  uint64_t state;  // of SplitMix
  int budget;      // how many, at least 1
};

// Descents from random starts, as many side by side as a vector has lanes,
// until one converges (kConverged) or the budget is used up (kImpatient), when
// `q` is the best pose that a descent ended at. Iterations of descents side by
// side count once.
using SearchArmFunction = ArmAttempt (*)(const ArmLayout& arm,
                                         const ArmSettings& settings,
                                         const ArmStarts& starts,
                                         const ArmTarget& target, ArmRow& q);

// A descent for each of `count` targets from its own pose, as many side by side
// as a vector has lanes; from random starts when that does not converge, unless
// `starts` is null. Poses of attempts that do not converge stay as they are.
using DescendArmsFunction = void (*)(const ArmLayout& arm,
                                     const ArmSettings& settings,
                                     const ArmStarts* starts,
                                     const ArmTarget* targets, int count,
                                     ArmRow* poses, ArmAttempt* attempts);

// The functions of one level of the instruction set.
struct ArmKernel {
  DescendArmFunction descend;
  SettleArmFunction settle;
  SearchArmFunction search;
  DescendArmsFunction descend_many;
};

namespace baseline {
ArmAttempt DescendArm(const ArmLayout&, const ArmSettings&, const ArmTarget&,
                      ArmRow&);
ArmAttempt SettleArm(const ArmLayout&, const ArmSettings&, double,
                     const ArmTarget&, ArmRow&);
ArmAttempt SearchArm(const ArmLayout&, const ArmSettings&, const ArmStarts&,
                     const ArmTarget&, ArmRow&);
void DescendArms(const ArmLayout&, const ArmSettings&, const ArmStarts*,
                 const ArmTarget*, int, ArmRow*, ArmAttempt*);
}  // namespace baseline
namespace avx2 {
ArmAttempt DescendArm(const ArmLayout&, const ArmSettings&, const ArmTarget&,
                      ArmRow&);
ArmAttempt SettleArm(const ArmLayout&, const ArmSettings&, double,
                     const ArmTarget&, ArmRow&);
ArmAttempt SearchArm(const ArmLayout&, const ArmSettings&, const ArmStarts&,
                     const ArmTarget&, ArmRow&);
void DescendArms(const ArmLayout&, const ArmSettings&, const ArmStarts*,
                 const ArmTarget*, int, ArmRow*, ArmAttempt*);
}  // namespace avx2
namespace avx512 {
ArmAttempt DescendArm(const ArmLayout&, const ArmSettings&, const ArmTarget&,
                      ArmRow&);
ArmAttempt SettleArm(const ArmLayout&, const ArmSettings&, double,
                     const ArmTarget&, ArmRow&);
ArmAttempt SearchArm(const ArmLayout&, const ArmSettings&, const ArmStarts&,
                     const ArmTarget&, ArmRow&);
void DescendArms(const ArmLayout&, const ArmSettings&, const ArmStarts*,
                 const ArmTarget*, int, ArmRow*, ArmAttempt*);
}  // namespace avx512

}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ARM_LAYOUT_H_
