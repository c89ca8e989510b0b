// What the kinds that place a frame have in common.
#ifndef GELENK_IK_GOALS_POSE_ROWS_H_
#define GELENK_IK_GOALS_POSE_ROWS_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "absl/strings/string_view.h"
#include "gelenk/ik/effector_task.h"
#include "gelenk/ik/goals/axis_mask.h"
#include "gelenk/ik/kernel/goal_rows.h"

namespace gelenk {

inline constexpr AxisMask kNoAxes = {false, false, false};

// A task on the frame of one effector, which must be there.
EffectorTask TaskOnEffector(const Skeleton& skeleton, absl::string_view id,
                            kernel::GoalShape shape, int translation_rows,
                            int rotation_rows);

// Shape and rows of a frame whose translation (if `translates`) and rotation
// count along these axes.
EffectorTask PoseTask(const Skeleton& skeleton, absl::string_view id,
                      bool translates, const AxisMask& rotation_axes);
void StorePoseRows(bool translates, const AxisMask& axes,
                   const AxisMask& rotation_axes, double rotation_scale,
                   double weight, kernel::TaskTarget& target);

// The weights of `translation_rows` + `rotation_rows` rows of `shape`.
void StoreScales(kernel::GoalShape shape, int translation_rows,
                 int rotation_rows, double rotation_scale, double weight,
                 kernel::TaskTarget& target);

void StoreRotation(const Eigen::Quaterniond& rotation,
                   kernel::TaskTarget& target);

// 2 sin(angle / 2) about the axis of the shortest rotation from `from` to `to`,
// world axes.
Eigen::Vector3d TurnFromTo(const Eigen::Matrix3d& from,
                           const Eigen::Matrix3d& to);

void LinearizePose(const kernel::TaskTarget& target,
                   const kernel::GoalFrame& frame, kernel::GoalRows& rows);
void LinearizePartialPose(const kernel::TaskTarget& target,
                          const kernel::GoalFrame& frame,
                          kernel::GoalRows& rows);

}  // namespace gelenk

#endif  // GELENK_IK_GOALS_POSE_ROWS_H_
