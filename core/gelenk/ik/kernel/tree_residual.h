// How far the goals of a tree are from where they ought to be.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_RESIDUAL_H_
#define GELENK_IK_KERNEL_TREE_RESIDUAL_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/ik/kernel/goal_rows.h"
#include "gelenk/ik/kernel/rotation_residual.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// 2 sin(angle / 2) about the axis of the rotation that is missing; returns its
// square.
GELENK_INLINE double RotationResidual(const double* to, const double* from,
                                      double* e) {
  // d = to * from^T
  double d[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      d[3 * i + j] = to[3 * i] * from[3 * j] + to[3 * i + 1] * from[3 * j + 1] +
                     to[3 * i + 2] * from[3 * j + 2];
    }
  }
  const double trace1 = 1 + d[0] + d[4] + d[8];  // 4 cos^2(angle/2)
  if (trace1 > kNearHalfTurn) {
    const double scale = 1 / __builtin_sqrt(trace1);
    e[0] = (d[7] - d[5]) * scale;
    e[1] = (d[2] - d[6]) * scale;
    e[2] = (d[3] - d[1]) * scale;
    return e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  }
  HalfTurnResidual(d, e);
  return e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
}

// Of a goal of another shape than a pose; its rows come along. Returns half the
// weighted square.
inline double ShapedResidual(const TreeState& state, int t, const Task& task) {
  const TaskTarget& target = state.targets[t];
  GoalFrame* frames = state.work.frames + kMaxGoalFrames * task.shaped;
  for (int f = 0; f < task.frame_count; ++f) {
    const TaskFrame& frame = state.tree.frames[task.frame_begin + f];
    Multiply(state.RotationOf(frame.node), frame.node_from_frame_rotation,
             frames[f].rotation);
    Transform(state.RotationOf(frame.node), state.TranslationOf(frame.node),
              frame.node_from_frame_translation, frames[f].translation);
  }
  GoalRows& rows = state.work.goal_rows[task.shaped];
  LinearizeGoal(target, frames, rows);
  state.work.position_errors2[t] = rows.position_error2;
  state.work.rotation_errors2[t] = rows.rotation_error2;
  double* e = state.work.residuals + 6 * t;
  double energy =
      target.row_scale[3] * target.row_scale[3] * rows.rotation_energy;
  for (int r = 0; r < task.row_end; ++r) {
    const bool translates = r < target.translation_rows;
    e[r] = rows.residual[r] * target.row_scale[translates ? r : 3];
    if (translates) energy += 0.5 * e[r] * e[r];
  }
  return energy;
}

// Residuals of all tasks in world axes: the way to the target, and
// 2 sin(angle/2) about the axis to it. Returns half their weighted square.
inline double Residuals(const TreeState& state) {
  double energy = 0;
  for (int t = 0; t < state.tree.task_count; ++t) {
    const Task& task = state.tree.tasks[t];
    const TaskTarget& target = state.targets[t];
    double* e = state.work.residuals + 6 * t;
    state.work.position_errors2[t] = 0;
    state.work.rotation_errors2[t] = 0;
    if (!target.active) continue;
    if (task.shape != GoalShape::kPose) {
      energy += ShapedResidual(state, t, task);
      continue;
    }
    const double* rotation = state.RotationOf(task.node);
    const double* translation = state.TranslationOf(task.node);
    double* tip = state.work.effectors + 3 * t;
    Transform(rotation, translation, task.node_from_effector_translation, tip);
    if (task.row_begin == 0) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) {
        e[k] = target.world_translation[k] - tip[k];
        sum += target.row_counts[k] * e[k] * e[k];
      }
      state.work.position_errors2[t] = sum;
    }
    if (task.row_end == 6 && target.row_scale[3] == 0) {
      for (int k = 3; k < 6; ++k) e[k] = 0;
    } else if (task.row_end == 6) {
      double turned[9];
      Multiply(rotation, task.node_from_effector_rotation, turned);
      state.work.rotation_errors2[t] =
          RotationResidual(target.world_rotation, turned, e + 3);
    }
    for (int k = task.row_begin; k < task.row_end; ++k) {
      e[k] *= target.row_scale[k];
      energy += 0.5 * e[k] * e[k];
    }
  }
  return energy;
}

inline bool IsWithinTolerance(const TreeState& state) {
  for (int t = 0; t < state.tree.task_count; ++t) {
    // So written that NaN is not within.
    if (!(state.work.position_errors2[t] <=
              state.settings.position_tolerance2 &&
          state.work.rotation_errors2[t] <=
              state.settings.rotation_tolerance2)) {
      return false;
    }
  }
  return true;
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_RESIDUAL_H_
