// The energy of an arm's pose, half the weighted squared error, to second order
// in the joints: exact, not what the residual's linear part makes of it.
//
// With t_i what joint i does to the tip's translation (weighted axes), a_i its
// axis and D = wanted * tip^-1 the turn that is missing:
//   dE/dq_i        = -t_i . e - w^2 a_i . sin(angle) axis
//   d2E/dq_i dq_j  = t_i . t_j - e . (a_i x t_j)
//                    + w^2 / 2 (a_i . a_j trace(D) - a_j . D a_i)
// for i at or before j on the way from the base.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_ARM_CURVATURE_H_
#define GELENK_IK_KERNEL_ARM_CURVATURE_H_

#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/arm_pose.h"

namespace gelenk::kernel {
namespace {

struct ArmCurvature {
  double slope[kMaxArmJoints];                   // dE/dq
  double hessian[kMaxArmJoints][kMaxArmJoints];  // lower triangle
};

template <int kWidth>
GELENK_INLINE void FindCurvature(const ArmPose<kWidth>& pose,
                                 const QuadFrame& wanted,
                                 const ArmSettings& settings,
                                 ArmCurvature& out) {
  const ArmLayout& arm = pose.arm;
  const Quad scale = QuadOf(settings.translation_scale);
  const Quad way = scale * scale * (wanted.origin - pose.tip.origin);
  const double weight = settings.rotation_scale * settings.rotation_scale;
  double d[9];
  TurnBetween(pose.tip, wanted, d);
  const double trace = d[0] + d[4] + d[8];
  const Quad sine_axis = {0.5 * (d[7] - d[5]), 0.5 * (d[2] - d[6]),
                          0.5 * (d[3] - d[1]), 0};
  Quad moves[kMaxArmJoints];   // t_i, axes not yet weighted
  Quad turned[kMaxArmJoints];  // trace a_i - D a_i
  for (int i = 0; i < arm.joint_count; ++i) {
    const Quad axis = pose.axes[i];
    const bool turns = arm.turn[i] != 0;
    moves[i] = turns ? Cross(axis, pose.tip.origin - pose.origins[i]) : axis;
    const Quad image = {Dot(QuadOf(d), axis), Dot(QuadOf(d + 3), axis),
                        Dot(QuadOf(d + 6), axis), 0};
    turned[i] = trace * axis - image;
    out.slope[i] = -Dot(moves[i], way);
    if (turns) out.slope[i] -= weight * Dot(axis, sine_axis);
    for (int j = 0; j <= i; ++j) {
      double h = Dot(moves[i] * scale, moves[j] * scale);
      if (arm.turn[j] != 0) {
        h -= Dot(way, Cross(pose.axes[j], moves[i]));
        if (turns) h += 0.5 * weight * Dot(axis, turned[j]);
      }
      out.hessian[i][j] = h;
    }
  }
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ARM_CURVATURE_H_
