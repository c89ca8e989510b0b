// How a tree moves along the step, and what its bounds leave of it.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_STEP_H_
#define GELENK_IK_KERNEL_TREE_STEP_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/scalar.h"
#include "gelenk/base/kernel/sine.h"
#include "gelenk/ik/kernel/descent.h"
#include "gelenk/ik/kernel/rotation_bounds.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Bounds of a turn and limits of a rotation are brought together in so many
// rounds; where they meet at a slant each leaves a part of the gap before.
constexpr int kBoundRounds = 16;

// Cuts the turn from `start` to `q` where it is larger than its bound; true
// when it was.
GELENK_INLINE bool KeepTurn(const TreeState& state, int i, const double* start,
                            double* q) {
  const double cosine = state.settings.turn_cosine[i];
  const double w =
      start[0] * q[0] + start[1] * q[1] + start[2] * q[2] + start[3] * q[3];
  if (Abs(w) >= cosine) return false;
  // q without its part along the start, which is at right angles to it.
  double across[4];
  double length2 = 0;
  for (int k = 0; k < 4; ++k) {
    across[k] = q[k] - w * start[k];
    length2 += across[k] * across[k];
  }
  const double sine =
      state.settings.turn_sine[i] / __builtin_sqrt(Max(length2, 1e-300));
  const double along = w < 0 ? -cosine : cosine;
  for (int k = 0; k < 4; ++k) q[k] = along * start[k] + sine * across[k];
  return true;
}

// The nearest rotation that keeps both bounds, by turns; limits come last, and
// hold whatever else was asked for.
GELENK_INLINE void KeepRotation(const TreeState& state, int i, double* q) {
  for (int round = 0; round < kBoundRounds; ++round) {
    const bool cut =
        state.settings.turn_start != nullptr &&
        KeepTurn(state, i, state.settings.turn_start + (q - state.q), q);
    if (round > 0 && !cut) break;
    if (!state.tree.nodes[i].limits_rotation ||
        IsWellInside(state.tree.rotation_limits[i], q)) {
      break;
    }
    ClampToRotationLimit(state.tree.rotation_limits[i], q);
  }
}

// Turns rotation q by `scale` times the step, inside its bounds.
GELENK_INLINE void StepRotation(const TreeState& state, int i, double scale,
                                const double* step, double* q) {
  double w[3] = {scale * step[0], scale * step[1], scale * step[2]};
  if (state.work.touched[i] != 0) {
    const double local[3] = {w[0], w[1], w[2]};
    const double zero[3] = {0, 0, 0};
    Transform(state.work.body_bases + 9 * i, zero, local, w);
  }
  const double angle2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
  double s = 0.5, c = 1;  // sin(angle/2)/angle, cos(angle/2)
  if (angle2 > 1e-16) {
    const double angle = __builtin_sqrt(angle2);
    SineCosine(0.5 * angle, &s, &c);
    s /= angle;
  } else if (angle2 == 0) {
    return;
  }
  const double turn[4] = {s * w[0], s * w[1], s * w[2], c};
  double out[4];
  MultiplyQuaternions(q, turn, out);
  const double inverse = 1 / __builtin_sqrt(out[0] * out[0] + out[1] * out[1] +
                                            out[2] * out[2] + out[3] * out[3]);
  for (int k = 0; k < 4; ++k) q[k] = out[k] * inverse;
  KeepRotation(state, i, q);
}

// Moves q by the step, shortened to kMaxStep, inside the bounds. Returns the
// largest change, rad or m.
inline double Move(const TreeState& state) {
  double largest = 0;
  for (int c = 0; c < state.tree.column_count; ++c) {
    largest = Max(largest, Abs(state.work.step[c]));
  }
  const double scale = largest > kMaxStep ? kMaxStep / largest : 1;
  for (int c = 0; c < state.tree.column_count; ++c) {
    const Column& column = state.tree.columns[c];
    if (column.position < 0) continue;
    const double value = state.q[column.position] + scale * state.work.step[c];
    state.q[column.position] =
        Min(Max(value, state.settings.lower[c]), state.settings.upper[c]);
  }
  for (int i = 0; i < state.tree.node_count; ++i) {
    const Node& node = state.tree.nodes[i];
    if (node.type == NodeType::kSpherical) {
      StepRotation(state, i, scale, state.work.step + node.axis,
                   state.q + node.position);
    } else if (node.type == NodeType::kFree) {
      StepRotation(state, i, scale, state.work.step + node.axis + 3,
                   state.q + node.position + 3);
    }
  }
  return scale * largest;
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_STEP_H_
