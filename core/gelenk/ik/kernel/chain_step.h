// The damped step of a chain, in the small space of its error, and how its
// limits change it.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_STEP_H_
#define GELENK_IK_KERNEL_CHAIN_STEP_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_frames.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_limits.h"
#include "gelenk/ik/kernel/chain_math.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/descent.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Times that a step is taken anew for coordinates that hit their limits.
constexpr int kActiveSetPasses = 2;

// force = W (W N W + damping)^-1 error, W the rows' weights.
GELENK_INLINE void SolveStep(const ChainState& state, double damping,
                             const double* error, double* force) {
  const double* w = state.target.row_scale;
  double m[6];
  int at = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j, ++at) m[at] = w[i] * w[j] * state.normal[at];
  }
  SolveDamped(m, damping, error, force);
  for (int k = 0; k < 3; ++k) force[k] *= w[k];
}

// S^-1 J^T force for what is free. Returns the longest change; `excess`
// receives by how much a coordinate would leave its limits at worst.
inline double FindChanges(const ChainState& state, const double* force,
                          double* excess) {
  Pack longest = {}, beyond = {};
  for (int part = 0; part < state.part_end; part += kWidth) {
    Pack v[3];
    ToSegments(state, force, part, v);
    for (int s = 0; s < state.chain.step_count; ++s) {
      LaneNumbers* record = state.RecordOf(state.chain.steps[s]);
      if (state.chain.steps[s].type == NodeType::kSpherical) {
        for (int c = 0; c < 3; ++c) {
          const Pack j[3] = {Get(record, kAxes + c, part),
                             Get(record, kAxes + 3 + c, part),
                             Get(record, kAxes + 6 + c, part)};
          const Pack change = Get(record, kWeights + c, part) * Dot(j, v);
          longest = Vector::Max(longest, Vector::Abs(change));
          Put(record, kChanges + c, part, change);
        }
        continue;
      }
      const Pack j[3] = {Get(record, kAxis, part), Get(record, kAxis + 1, part),
                         Get(record, kAxis + 2, part)};
      const Pack weight = Get(record, kWeight, part);
      // What was stopped keeps its change.
      const Pack change =
          weight > 0 ? weight * Dot(j, v) : Get(record, kChange, part);
      const Pack q = Get(record, kAngle, part) + change;
      longest = Vector::Max(longest, Vector::Abs(change));
      beyond = Vector::Max(beyond, Get(record, kLower, part) - q);
      beyond = Vector::Max(beyond, q - Get(record, kUpper, part));
      Put(record, kChange, part, change);
    }
  }
  *excess = Vector::Largest(beyond);
  return Vector::Largest(longest);
}

// Stops the coordinates that would leave their limits there, and takes their
// part out of the normal matrix and of the error `left` for the others.
inline void StopAtLimits(ChainState& state, double* left) {
  Pack sum[6] = {}, moved[3] = {};
  for (int part = 0; part < state.part_end; part += kWidth) {
    Pack m[6] = {}, shift[3] = {};
    for (int s = 0; s < state.chain.step_count; ++s) {
      if (state.chain.steps[s].type == NodeType::kSpherical) continue;
      LaneNumbers* record = state.RecordOf(state.chain.steps[s]);
      const Pack j[3] = {Get(record, kAxis, part), Get(record, kAxis + 1, part),
                         Get(record, kAxis + 2, part)};
      const Pack weight = Get(record, kWeight, part);
      const Pack q = Get(record, kAngle, part);
      const Pack change = Get(record, kChange, part);
      const Pack down = Get(record, kLower, part) - q;
      const Pack up = Get(record, kUpper, part) - q;
      const Mask stops = (weight > 0) & ((change < down) | (change > up));
      const Pack zero = {};
      const Pack way = stops ? (change < down ? down : up) : zero;
      Accumulate(j, stops ? weight : zero, m);
      for (int k = 0; k < 3; ++k) shift[k] += way * j[k];
      Put(record, kWeight, part, stops ? zero : weight);
      Put(record, kChange, part, stops ? way : change);
    }
    AddToWorld(state, m, part, sum);
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        moved[i] += Get(state.base_rotation, 3 * i + k, part) * shift[k];
      }
    }
  }
  for (int k = 0; k < 6; ++k) state.normal[k] -= Vector::Sum(sum[k]);
  for (int k = 0; k < 3; ++k) {
    left[k] -= state.target.row_scale[k] * Vector::Sum(moved[k]);
  }
}

GELENK_INLINE void MoveRotation(const ChainStep& step, LaneNumbers* record,
                                int part, double scale) {
  Pack w[3], q[4], moved[4];
  for (int k = 0; k < 3; ++k) w[k] = scale * Get(record, kChanges + k, part);
  if (step.limits_rotation) {
    Pack basis[9], body[3] = {};
    for (int k = 0; k < 9; ++k) basis[k] = Get(record, kBasis + k, part);
    AddTransformed(basis, w, body);
    for (int k = 0; k < 3; ++k) w[k] = body[k];
  }
  for (int k = 0; k < 4; ++k) q[k] = Get(record, kQuaternion + k, part);
  Rotate(q, w, moved);
  for (int k = 0; k < 4; ++k) Put(record, kQuaternion + k, part, moved[k]);
}

// Moves q by `scale` times the changes, inside the limits.
inline void Move(const ChainState& state, double scale) {
  for (int s = 0; s < state.chain.step_count; ++s) {
    const ChainStep& step = state.chain.steps[s];
    LaneNumbers* record = state.RecordOf(step);
    for (int part = 0; part < state.part_end; part += kWidth) {
      if (step.type == NodeType::kSpherical) {
        MoveRotation(step, record, part, scale);
        continue;
      }
      const Pack q =
          Get(record, kAngle, part) + scale * Get(record, kChange, part);
      Put(record, kAngle, part,
          Vector::Min(Vector::Max(q, Get(record, kLower, part)),
                      Get(record, kUpper, part)));
    }
    if (step.limits_rotation) {
      ClampRotations(state, step, record);
      TouchLimits(state, step, record);
    }
  }
}

// Takes the damped step. Where it would leave the limits, the coordinates
// that hit them stop there, and the others make up for it.
inline void Step(ChainState& state, double damping) {
  double force[3];
  SolveStep(state, damping, state.error, force);
  double excess;
  const double longest = FindChanges(state, force, &excess);
  const double scale = longest > kMaxStep ? kMaxStep / longest : 1;
  if (scale == 1 && excess > 0) {
    double left[3] = {state.error[0], state.error[1], state.error[2]};
    for (int pass = 0; pass < kActiveSetPasses && excess > 0; ++pass) {
      StopAtLimits(state, left);
      SolveStep(state, damping, left, force);
      FindChanges(state, force, &excess);
    }
  }
  Move(state, scale);
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_STEP_H_
