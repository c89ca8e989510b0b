// When the kernels of arms go how far, and when they give up.
//
// For the kernels only, like base/kernel/lanes.h.
#ifndef GELENK_IK_KERNEL_ARM_POLICY_H_
#define GELENK_IK_KERNEL_ARM_POLICY_H_

#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/arm_layout.h"

namespace gelenk::kernel {
namespace {

// lambda = kDampingPerEnergy * energy + kDampingFloor (Sugihara 2011): strong
// far away, gone at the target. Steps are never rejected: with this damping
// none is longer than 4 rad, and those that miss are made good sooner than
// looked into.
constexpr double kArmDampingPerEnergy = 3e-2;
constexpr double kArmDampingFloor = 1e-9;

// So many iterations must bring the energy below this part of what it was; near
// a solution each does far better, and another start is cheap.
constexpr int kArmWindow = 5;
constexpr double kArmWindowGain = 0.3;

GELENK_INLINE bool IsToStop(const ArmSettings& settings) {
  return settings.stop != nullptr && settings.stop(settings.stop_context);
}

}  // namespace
}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_ARM_POLICY_H_
