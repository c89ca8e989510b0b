// The pull of a posture on the joints of a tree: its energy, its gradient and
// its part of the normal matrix.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_POSTURE_H_
#define GELENK_IK_KERNEL_TREE_POSTURE_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// The rotation from where a joint is to its posture, in its body frame, by
// the shorter way: sin(angle / 2) times the axis, cos(angle / 2).
GELENK_INLINE void BodyTurn(const TreeState& state, const PostureTerm& term,
                            double* turn) {
  const double* q = state.q + term.position;
  const double* t = term.target;
  turn[0] = q[3] * t[0] - t[3] * q[0] - (q[1] * t[2] - q[2] * t[1]);
  turn[1] = q[3] * t[1] - t[3] * q[1] - (q[2] * t[0] - q[0] * t[2]);
  turn[2] = q[3] * t[2] - t[3] * q[2] - (q[0] * t[1] - q[1] * t[0]);
  turn[3] = q[0] * t[0] + q[1] * t[1] + q[2] * t[2] + q[3] * t[3];
  if (turn[3] >= 0) return;
  for (int k = 0; k < 4; ++k) turn[k] = -turn[k];
}

// Of one joint. A rotation's is 4 (1 - cos(angle / 2)), whose gradient is the
// rotation vector below.
GELENK_INLINE double PostureEnergy(const TreeState& state,
                                   const PostureTerm& term) {
  if (!term.rotation) {
    const double way = term.target[0] - state.q[term.position];
    return 0.5 * term.weight * way * way;
  }
  double turn[4];
  BodyTurn(state, term, turn);
  const double sine2 =
      turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2];
  return term.weight * 4 * sine2 / (1 + turn[3]);
}

// The gradient of a posture, in the basis in which the joint moves.
inline void PullBack(const TreeState& state, const PostureTerm& term) {
  double* g = state.work.gradient + term.column;
  if (!term.rotation) {
    g[0] += term.weight * (term.target[0] - state.q[term.position]);
    return;
  }
  double turn[4];
  BodyTurn(state, term, turn);
  const int node = state.tree.columns[term.column].node;
  const double* basis = state.work.body_bases + 9 * node;
  for (int k = 0; k < 3; ++k) {
    const double along = state.work.touched[node] == 0
                             ? turn[k]
                             : basis[k] * turn[0] + basis[3 + k] * turn[1] +
                                   basis[6 + k] * turn[2];
    g[k] += 2 * term.weight * along;
  }
}

// Its part of H: diagonal but where a rotation's basis is not orthogonal.
inline void Stiffen(const TreeState& state, const PostureTerm& term) {
  const int count = term.rotation ? 3 : 1;
  for (int k = 0; k < count; ++k) {
    const Column& column = state.tree.columns[term.column + k];
    double* row = state.work.h + column.row;
    const bool touched = term.rotation && state.work.touched[column.node] != 0;
    if (!touched) {
      row[column.depth] += term.weight;
      continue;
    }
    const double* basis = state.work.body_bases + 9 * column.node;
    for (int m = 0; m <= k; ++m) {
      const double product = basis[k] * basis[m] + basis[3 + k] * basis[3 + m] +
                             basis[6 + k] * basis[6 + m];
      row[column.depth - k + m] += term.weight * product;
    }
  }
}

// Half the weighted squared way back, of all joints that have a posture.
inline double PostureEnergy(const TreeState& state) {
  double energy = 0;
  for (int i = 0; i < state.settings.posture_count; ++i) {
    energy += PostureEnergy(state, state.settings.posture[i]);
  }
  return energy;
}

// Adds the gradients of all postures.
inline void LinearizePosture(const TreeState& state) {
  for (int i = 0; i < state.settings.posture_count; ++i) {
    PullBack(state, state.settings.posture[i]);
  }
}

// Adds their parts of H.
inline void AccumulatePosture(const TreeState& state) {
  for (int i = 0; i < state.settings.posture_count; ++i) {
    Stiffen(state, state.settings.posture[i]);
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_POSTURE_H_
