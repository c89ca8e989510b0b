// A goal as a function of the frames that it looks at: its residual, and how
// that shrinks as the frames move. Flat and plain, like tree_layout.h; computed
// out of line, once per goal and iteration (about 20 to 60 ns).
//
// Whoever knows how the degrees of freedom move the frames has the rows of the
// goal's Jacobian: the sum over frames f of rows[f] * J_f, with J_f the
// geometric Jacobian of f (see kinematics/jacobian.h).
//
// Rows of an angle have the length 2 sin(angle / 2) and point along the axis
// that closes it. Taken as the gradient of 4 (1 - cos(angle / 2)) they are
// exact at every angle, half a turn included, where the gradient of their own
// square would vanish and a solver would stand still.
#ifndef GELENK_IK_KERNEL_GOAL_ROWS_H_
#define GELENK_IK_KERNEL_GOAL_ROWS_H_

#include <cstdint>

namespace gelenk::kernel {

// Row-major.
using Matrix3 = double[9];
using Vector3 = double[3];

// The root, middle and tip of a limb.
inline constexpr int kMaxGoalFrames = 3;
inline constexpr int kMaxGoalRows = 6;

// How a residual is made of frames.
enum class GoalShape : uint8_t {
  kNone,          // of none: whatever the goal wants is not said in rows
  kPose,          // translation and rotation of one frame
  kPartialPose,   // the same, with one or two rotation axes that count
  kAim,           // a direction of one frame at a point
  kPole,          // three points
  kHalfSpace,     // one point and a plane
  kRelative,      // one frame in another
  kCenterOfMass,  // one point, that of no frame
};

// What a goal wants at present.
struct TaskTarget {
  // Of frames and points, as the shape has them.
  Matrix3 world_rotation;
  Vector3 world_translation;
  // Of an aim, its axis in the effector's frame; of a half-space, its normal;
  // of a partial rotation, the axis that is free (of two) or counts (alone).
  Vector3 direction;
  // Of a half-space, its plane's.
  double offset;
  // Square roots of the rows' weights: three of a translation, where a masked
  // one has 0, and the same number three times for every angle.
  double row_scale[6];
  // The same without the goal's weight: which rows count for the error.
  double row_counts[3];
  GoalShape shape;
  // Rows of each sort.
  int8_t translation_rows;
  int8_t rotation_rows;
  bool active;
  // A plant that has no pose to hold yet.
  bool free;
};

// world_from_frame.
struct GoalFrame {
  Matrix3 rotation;
  Vector3 translation;
};

struct GoalRows {
  // First those of a translation, m, then those of angles.
  double residual[kMaxGoalRows];
  // By which residual[r] falls for each unit of the frame's velocity and
  // angular velocity, world axes.
  double rows[kMaxGoalFrames][kMaxGoalRows][6];
  // Of the angles, without their weight.
  double rotation_energy;
  // Squared errors, m^2 and (2 sin(angle / 2))^2.
  double position_error2;
  double rotation_error2;
  // Of a half-space, how far its point is on the free side, m; negative behind.
  double clearance;
};

// Fills translation_rows + rotation_rows rows; without weights.
void LinearizeGoal(const TaskTarget& target, const GoalFrame* frames,
                   GoalRows& rows);

}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_GOAL_ROWS_H_
