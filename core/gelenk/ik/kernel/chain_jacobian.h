// What a chain's coordinates do to its tip, which of them are held by their
// limits, and the normal matrix J S^-1 J^T.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_JACOBIAN_H_
#define GELENK_IK_KERNEL_CHAIN_JACOBIAN_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_frames.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_limits.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Notes how much g pushes: what may move, or what is held by a limit.
GELENK_INLINE void Note(const Pack& g, const Pack& weight,
                        const Pack& compliance, Pack* pushed, Pack* largest) {
  const Pack size = Vector::Abs(g);
  const Pack zero = {};
  *largest = Vector::Max(*largest, weight > 0 ? size : zero);
  *pushed =
      Vector::Max(*pushed, (weight == 0) & (compliance > 0) ? size : zero);
}

GELENK_INLINE void LinearizeScalar(const ChainStep& step, LaneNumbers* record,
                                   int part, const Pack* tip, const Pack* e,
                                   Pack* m, Pack* pushed, Pack* largest) {
  Pack axis[3], j[3];
  for (int k = 0; k < 3; ++k) axis[k] = Get(record, kAxis + k, part);
  if (step.type == NodeType::kRevolute) {
    Pack arm[3];
    for (int k = 0; k < 3; ++k)
      arm[k] = tip[k] - Get(record, kOrigin + k, part);
    Cross(axis, arm, j);
  } else {
    for (int k = 0; k < 3; ++k) j[k] = axis[k];
  }
  const Pack g = Dot(j, e);
  const Pack q = Get(record, kAngle, part);
  const Pack lower = Get(record, kLower, part),
             upper = Get(record, kUpper, part);
  const Mask blocked =
      ((q <= lower) & (g < 0)) | ((q >= upper) & (g > 0)) | (lower == upper);
  const Pack compliance = Get(step.compliance, 0, part);
  const Pack zero = {};
  const Pack weight = blocked ? zero : compliance;
  Put(record, kChange, part, zero);
  Note(g, weight, compliance, pushed, largest);
  Accumulate(j, weight, m);
  Put(record, kWeight, part, weight);
  for (int k = 0; k < 3; ++k) Put(record, kAxis + k, part, j[k]);
}

GELENK_INLINE void LinearizeSpherical(const ChainState& state,
                                      const ChainStep& step,
                                      LaneNumbers* record, int part,
                                      const Pack* tip, const Pack* e, Pack* m,
                                      Pack* pushed, Pack* largest) {
  Pack arm[3], j[3][3], g[3], weight[3];
  for (int k = 0; k < 3; ++k) arm[k] = tip[k] - Get(record, kCenter + k, part);
  for (int c = 0; c < 3; ++c) {
    const Pack axis[3] = {Get(record, kAxes + c, part),
                          Get(record, kAxes + 3 + c, part),
                          Get(record, kAxes + 6 + c, part)};
    Cross(axis, arm, j[c]);
    g[c] = Dot(j[c], e);
    weight[c] = Get(step.compliance, c, part);
  }
  if (step.limits_rotation) BlockRotations(state, step, part, g, weight);
  for (int c = 0; c < 3; ++c) {
    Note(g[c], weight[c], Get(step.compliance, c, part), pushed, largest);
    Accumulate(j[c], weight[c], m);
    Put(record, kWeights + c, part, weight[c]);
    for (int k = 0; k < 3; ++k) Put(record, kAxes + 3 * k + c, part, j[c][k]);
  }
}

// Jacobians, what is free to move, and J S^-1 J^T. Returns whether something
// is pushed against a limit.
inline bool Linearize(ChainState& state) {
  Pack sum[6] = {};
  double force[3];
  for (int k = 0; k < 3; ++k)
    force[k] = state.target.row_scale[k] * state.error[k];
  Pack pushed = {}, largest = {};
  for (int part = 0; part < state.part_end; part += kWidth) {
    Pack e[3], tip[3], m[6] = {};
    ToSegments(state, force, part, e);
    TipInSegments(state, part, tip);
    for (int s = 0; s < state.chain.step_count; ++s) {
      const ChainStep& step = state.chain.steps[s];
      LaneNumbers* record = state.RecordOf(step);
      if (step.type == NodeType::kSpherical) {
        LinearizeSpherical(state, step, record, part, tip, e, m, &pushed,
                           &largest);
      } else {
        LinearizeScalar(step, record, part, tip, e, m, &pushed, &largest);
      }
    }
    AddToWorld(state, m, part, sum);
  }
  for (int k = 0; k < 6; ++k) state.normal[k] = Vector::Sum(sum[k]);
  const double most = Vector::Largest(pushed);
  return most > 0 && most > 10 * Vector::Largest(largest);
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_JACOBIAN_H_
