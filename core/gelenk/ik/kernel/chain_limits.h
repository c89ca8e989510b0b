// The limits of a chain's rotations, lane by lane.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_LIMITS_H_
#define GELENK_IK_KERNEL_CHAIN_LIMITS_H_

#include <cstdint>

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/rotation_bounds.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Which limits each rotation touches, and the axes in which they are a box.
inline void TouchLimits(const ChainState& state, const ChainStep& step,
                        LaneNumbers* record) {
  for (int lane = 0; lane < kChainLanes; ++lane) {
    double basis[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (step.node[lane] >= 0) {
      uint8_t& touched = state.work.touched[step.node[lane]];
      touched = 0;
      if (step.limited[lane]) {
        const RotationLimit& limit =
            state.chain.rotation_limits[step.node[lane]];
        double q[4];
        for (int k = 0; k < 4; ++k) q[k] = record[kQuaternion + k][lane];
        if (!IsWellInside(limit, q)) {
          touched = TouchRotationLimit(limit, q, basis);
        }
      }
    }
    for (int k = 0; k < 9; ++k) record[kBasis + k][lane] = basis[k];
  }
}

// Moves the rotations inside their limits.
inline void ClampRotations(const ChainState& state, const ChainStep& step,
                           LaneNumbers* record) {
  for (int lane = 0; lane < kChainLanes; ++lane) {
    if (!step.limited[lane]) continue;
    const RotationLimit& limit = state.chain.rotation_limits[step.node[lane]];
    double q[4];
    for (int k = 0; k < 4; ++k) q[k] = record[kQuaternion + k][lane];
    if (IsWellInside(limit, q)) continue;
    ClampToRotationLimit(limit, q);
    for (int k = 0; k < 4; ++k) record[kQuaternion + k][lane] = q[k];
  }
}

// Takes the weight from columns that touched limits hold.
inline void BlockRotations(const ChainState& state, const ChainStep& step,
                           int part, const Pack* g, Pack* weight) {
  for (int i = 0; i < kWidth; ++i) {
    if (!step.limited[part + i]) continue;
    const uint8_t touched = state.work.touched[step.node[part + i]];
    if (touched == 0) continue;
    if (BlocksTurn(touched, 0, g[0][i])) weight[0][i] = 0;
    if (BlocksTurn(touched, 1, g[1][i])) weight[1][i] = 0;
    if (BlocksTurn(touched, 2, g[2][i])) weight[2][i] = 0;
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_LIMITS_H_
