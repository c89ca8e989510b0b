// The normal system of a tree, H step = gradient, on its packed rows (see
// tree_layout.h): blocked columns take no part.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_NORMAL_SYSTEM_H_
#define GELENK_IK_KERNEL_TREE_NORMAL_SYSTEM_H_

#include "gelenk/base/kernel/lanes.h"
#include "gelenk/base/kernel/scalar.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr int kLanes = GELENK_KERNEL_LANES;
static_assert(kRowAlignment % kLanes == 0);
using Pack = Lanes<kLanes>::Pack;

template <int kRows>
GELENK_INLINE void AccumulateRows(const TreeState& state, const Task& task,
                                  const double* j, int stride) {
  const PathColumn* path = state.tree.path_columns + task.path_begin;
  for (int k = 0; k < task.path_size; ++k) {
    const int c = path[k].column;
    if (state.work.blocked[c]) continue;
    Pack* h = reinterpret_cast<Pack*>(state.work.h + state.tree.columns[c].row);
    double scale[kRows];
    for (int r = 0; r < kRows; ++r) scale[r] = j[r * stride + k];
    for (int v = 0; v <= k / kLanes; ++v) {
      Pack sum = h[v];
      for (int r = 0; r < kRows; ++r) {
        sum += scale[r] * reinterpret_cast<const Pack*>(j + r * stride)[v];
      }
      h[v] = sum;
    }
  }
}

// H = J^T J over all tasks, on the packed rows.
inline void AccumulateGoals(const TreeState& state) {
  const Pack zero = {};
  Pack* h = reinterpret_cast<Pack*>(state.work.h);
  for (int i = 0; i < state.tree.h_size / kLanes; ++i) h[i] = zero;
  const double* j = state.work.jacobian;
  for (int t = 0; t < state.tree.task_count; ++t) {
    const Task& task = state.tree.tasks[t];
    const int stride = PaddedRow(task.path_size);
    if (state.targets[t].active) {
      const double* rows = j + task.row_begin * stride;
      switch (task.row_end - task.row_begin) {
        case 6:
          AccumulateRows<6>(state, task, rows, stride);
          break;
        case 3:
          AccumulateRows<3>(state, task, rows, stride);
          break;
        default:
          for (int r = task.row_begin; r < task.row_end; ++r) {
            AccumulateRows<1>(state, task, j + r * stride, stride);
          }
      }
    }
    j += 6 * stride;
  }
}

// H + damping -> L^T D L in place, leaf first; the diagonal holds 1/D.
inline void Factorize(const TreeState& state, double damping) {
  for (int c = state.tree.column_count - 1; c >= 0; --c) {
    const Column& column = state.tree.columns[c];
    double* row = state.work.h + column.row;
    const int depth = column.depth;
    if (state.work.blocked[c]) {
      for (int m = 0; m < depth; ++m) row[m] = 0;
      row[depth] = 1;
      continue;
    }
    const double inverse = 1 / (row[depth] + damping * column.stiffness);
    row[depth] = inverse;
    const PathColumn* ancestors = state.tree.path_columns + column.ancestors;
    const Pack* source = reinterpret_cast<const Pack*>(row);
    for (int m = 0; m < depth; ++m) {
      const int a = ancestors[m].column;
      if (state.work.blocked[a]) {
        row[m] = 0;
        continue;
      }
      const double scale = row[m] * inverse;
      Pack* h =
          reinterpret_cast<Pack*>(state.work.h + state.tree.columns[a].row);
      for (int v = 0; v <= m / kLanes; ++v) h[v] -= scale * source[v];
    }
    for (int m = 0; m < depth; ++m) row[m] *= inverse;
  }
}

// step = (L^T D L)^-1 gradient.
inline void Solve(const TreeState& state) {
  double* x = state.work.step;
  Copy(state.work.gradient, x, state.tree.column_count);
  for (int c = state.tree.column_count - 1; c >= 0; --c) {
    const Column& column = state.tree.columns[c];
    const double* row = state.work.h + column.row;
    const PathColumn* ancestors = state.tree.path_columns + column.ancestors;
    const double value = x[c];
    for (int m = 0; m < column.depth; ++m) {
      x[ancestors[m].column] -= row[m] * value;
    }
  }
  for (int c = 0; c < state.tree.column_count; ++c) {
    const Column& column = state.tree.columns[c];
    const double* row = state.work.h + column.row;
    const PathColumn* ancestors = state.tree.path_columns + column.ancestors;
    double value = x[c] * row[column.depth];
    for (int m = 0; m < column.depth; ++m) {
      value -= row[m] * x[ancestors[m].column];
    }
    x[c] = state.work.blocked[c] ? 0 : value;
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_NORMAL_SYSTEM_H_
