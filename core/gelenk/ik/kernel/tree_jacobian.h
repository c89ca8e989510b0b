// The rows of the goals' Jacobians, a padded row of the columns on the goal's
// path each, and the gradient: J^T times the residual.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_JACOBIAN_H_
#define GELENK_IK_KERNEL_TREE_JACOBIAN_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Velocity and angular velocity of point `tip` in a unit of motion about `axis`
// through `origin`, or along it.
GELENK_INLINE void FindMotion(const double* axis, const double* origin,
                              bool rotation, const double* tip,
                              double* motion) {
  for (int k = 0; k < 3; ++k) motion[k] = axis[k], motion[3 + k] = 0;
  if (rotation) {
    const double d[3] = {tip[0] - origin[0], tip[1] - origin[1],
                         tip[2] - origin[2]};
    Cross(axis, d, motion);
    for (int k = 0; k < 3; ++k) motion[3 + k] = axis[k];
  }
}

GELENK_INLINE void AddColumn(const double* axis, const double* origin,
                             bool rotation, const double* tip, double scale,
                             const Task& task, double* j, int stride) {
  double column[6];
  FindMotion(axis, origin, rotation, tip, column);
  for (int r = task.row_begin; r < task.row_end; ++r) {
    j[r * stride] += scale * column[r];
  }
}

inline void LinearizeTask(const TreeState& state, int t, const Task& task,
                          double* j, int stride) {
  const double* tip = state.work.effectors + 3 * t;
  const TaskTarget& target = state.targets[t];
  const PathColumn* path = state.tree.path_columns + task.path_begin;
  for (int i = task.row_begin * stride; i < task.row_end * stride; ++i) {
    j[i] = 0;
  }
  for (int k = 0; k < task.path_size; ++k) {
    if (path[k].absent) continue;
    AddColumn(state.work.axes + 3 * path[k].column,
              state.work.node_translation + 3 * path[k].node, path[k].rotation,
              tip, 1, task, j + k, stride);
  }
  const PathFollower* followers = state.tree.followers + task.follower_begin;
  for (int f = 0; f < task.follower_count; ++f) {
    AddColumn(state.work.axes + 3 * followers[f].axis,
              state.work.node_translation + 3 * followers[f].node,
              followers[f].rotation, tip, followers[f].multiplier, task,
              j + followers[f].place, stride);
  }
  const double* e = state.work.residuals + 6 * t;
  for (int r = task.row_begin; r < task.row_end; ++r) {
    double* row = j + r * stride;
    for (int k = 0; k < task.path_size; ++k) {
      row[k] *= target.row_scale[r];
      state.work.gradient[path[k].column] += row[k] * e[r];
    }
  }
}

GELENK_INLINE void AddShapedColumn(const TreeState& state, const double* axis,
                                   int node, bool rotation, double scale,
                                   const Task& task, double* j, int stride) {
  const GoalFrame* frames = state.work.frames + kMaxGoalFrames * task.shaped;
  const GoalRows& rows = state.work.goal_rows[task.shaped];
  const double* origin = state.work.node_translation + 3 * node;
  for (int f = 0; f < task.frame_count; ++f) {
    if (node > state.tree.frames[task.frame_begin + f].node) continue;
    double motion[6];
    FindMotion(axis, origin, rotation, frames[f].translation, motion);
    for (int r = 0; r < task.row_end; ++r) {
      const double* row = rows.rows[f][r];
      double sum = 0;
      for (int i = 0; i < 6; ++i) sum += row[i] * motion[i];
      j[r * stride] += scale * sum;
    }
  }
}

// By way of the frames that the goal looks at.
inline void LinearizeShaped(const TreeState& state, int t, const Task& task,
                            double* j, int stride) {
  const TaskTarget& target = state.targets[t];
  const PathColumn* path = state.tree.path_columns + task.path_begin;
  for (int i = 0; i < task.row_end * stride; ++i) j[i] = 0;
  for (int k = 0; k < task.path_size; ++k) {
    if (path[k].absent) continue;
    AddShapedColumn(state, state.work.axes + 3 * path[k].column, path[k].node,
                    path[k].rotation, 1, task, j + k, stride);
  }
  const PathFollower* followers = state.tree.followers + task.follower_begin;
  for (int f = 0; f < task.follower_count; ++f) {
    AddShapedColumn(state, state.work.axes + 3 * followers[f].axis,
                    followers[f].node, followers[f].rotation,
                    followers[f].multiplier, task, j + followers[f].place,
                    stride);
  }
  const double* e = state.work.residuals + 6 * t;
  for (int r = 0; r < task.row_end; ++r) {
    const double scale = target.row_scale[r < target.translation_rows ? r : 3];
    double* row = j + r * stride;
    for (int k = 0; k < task.path_size; ++k) {
      row[k] *= scale;
      state.work.gradient[path[k].column] += row[k] * e[r];
    }
  }
}

// Weighted Jacobians of all tasks, six padded rows each, and the gradient.
inline void LinearizeGoals(const TreeState& state) {
  for (int c = 0; c < state.tree.column_count; ++c) state.work.gradient[c] = 0;
  double* j = state.work.jacobian;
  for (int t = 0; t < state.tree.task_count; ++t) {
    const Task& task = state.tree.tasks[t];
    const int stride = PaddedRow(task.path_size);
    if (state.targets[t].active && task.shape == GoalShape::kPose) {
      LinearizeTask(state, t, task, j, stride);
    } else if (state.targets[t].active) {
      LinearizeShaped(state, t, task, j, stride);
    }
    j += 6 * stride;
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_JACOBIAN_H_
