// The data that the solver's inner loop works on: flat, plain, no library type,
// so that the loop can be compiled once per level of the instruction set.
//
// A skeleton is reduced to what moves a goal: *nodes* (moving joints that are
// ancestors of an effector, parents first; fixed joints are folded into
// offsets) and *columns* (their degrees of freedom, parents first). Each node's
// frame is turned so that a revolute, prismatic or planar joint moves about or
// along its own z.
//
// A *path* is the list of columns between the root and an effector. The
// ancestors of a column are a prefix of any path that holds it, so the rows of
// the normal matrix H are stored packed, root first, and its factorisation
// H = L^T D L, leaf first, fills in nothing and touches contiguous memory only
// (Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 6). A joint that
// others mimic has its column placed at the common ancestor of all of them,
// which keeps that property.
#ifndef GELENK_IK_KERNEL_TREE_LAYOUT_H_
#define GELENK_IK_KERNEL_TREE_LAYOUT_H_

#include <cstdint>

#include "gelenk/ik/kernel/goal_rows.h"

namespace gelenk::kernel {

// Rows of J and H are padded to whole vectors of the widest level.
inline constexpr int kRowAlignment = 8;
inline constexpr int PaddedRow(int count) {
  return (count + kRowAlignment - 1) / kRowAlignment * kRowAlignment;
}

enum class NodeType : uint8_t {
  kRevolute,
  kPrismatic,
  kSpherical,
  kPlanar,
  kFree,
};

struct Node {
  Matrix3 parent_from_rest_rotation;
  Vector3 parent_from_rest_translation;
  int parent;    // node, -1 for the base
  int position;  // first number in q that moves it
  int axis;      // first axis slot: its columns, or its own as a mimic
  NodeType type;
  bool offset_is_translation;  // no rotation between parent and rest
  bool mimics;                 // moved by another joint's number
  bool limits_rotation;        // has a swing cone or twist range
  double multiplier;           // of that number
  double offset;               // added to it
};

// Swing cone and twist range of one node's rotation. Infinite where unset.
struct RotationLimit {
  Vector3 axis;
  double swing_cone;
  double twist_lower;
  double twist_upper;
  // Quick test, exact inside: sin^2(cone/2), and tan(range/2) where the range
  // lies within half a turn of zero.
  double swing_sine2;
  double twist_tangent_lower;
  double twist_tangent_upper;
  bool quick;
};

struct Column {
  int node;       // whose motion it is
  int position;   // in q; -1 for a rotation's
  int depth;      // columns above it
  int row;        // first number of its packed row of H
  int ancestors;  // where its ancestors start in TreeLayout::path_columns
  double stiffness;
};

// How one place of a path adds to the Jacobian.
struct PathColumn {
  int column;
  int node;       // whose origin it turns about
  bool rotation;  // else a translation
  bool absent;    // only there to keep the prefix; zero but for followers
};

// A mimic joint on the path: its motion belongs to the column it follows.
struct PathFollower {
  int place;  // in the path
  int axis;   // slot
  int node;
  bool rotation;
  double multiplier;
};

// What one goal wants of one effector.
struct Task {
  int node;  // that carries the effector, -1 for the base
  Matrix3 node_from_effector_rotation;
  Vector3 node_from_effector_translation;
  int path_begin;  // in path_columns
  int path_size;
  int follower_begin;
  int follower_count;
  int row_begin;  // rows of the residual in use: of a pose 0-2 translation,
  int row_end;    // 3-5 rotation; of another shape from 0 on
  GoalShape shape;
  int shaped;       // index among the tasks of a shape other than a pose
  int frame_begin;  // in TreeLayout::frames, of shapes other than a pose
  int frame_count;
};

// A frame that a goal looks at, on the task's path.
struct TaskFrame {
  int node;  // that carries it, -1 for the base
  Matrix3 node_from_frame_rotation;
  Vector3 node_from_frame_translation;
};

// How far one joint should go back to a posture: one number, or a rotation.
struct PostureTerm {
  int column;    // the first of its columns
  int position;  // the first of its numbers in q
  bool rotation;
  double weight;
  double target[4];
};

struct TreeLayout {
  const Node* nodes;
  const RotationLimit* rotation_limits;  // per node, read if limits_rotation
  const Column* columns;
  // Per column the skeleton's bounds of q[position]; infinite for a rotation's.
  const double* lower;
  const double* upper;
  const PathColumn* path_columns;
  const PathFollower* followers;
  const Task* tasks;
  const TaskFrame* frames;
  int node_count;
  int column_count;
  int axis_count;  // columns, then mimic joints
  int task_count;
  int h_size;  // numbers in the packed H
  int j_size;  // numbers in the Jacobians of all tasks
  int position_count;
  int shaped_count;  // tasks of a shape other than a pose
};

struct Settings {
  Matrix3 base_rotation;  // world_from_skeleton
  Vector3 base_translation;
  double position_tolerance2;  // m^2
  double rotation_tolerance2;  // (2 sin(angle / 2))^2
  // Per column the bounds that this solve keeps: those of the layout, or
  // narrower ones. The start must be inside.
  const double* lower;
  const double* upper;
  // Null, or q from which rotations may turn no further than a bound: per node
  // the cosine and the sine of half of it.
  const double* turn_start;
  const double* turn_cosine;
  const double* turn_sine;
  const PostureTerm* posture;
  int posture_count;
  int max_iterations;
  // Give up as soon as a window of iterations does not halve the error: there
  // are other starts to try.
  bool impatient;
  // Asked once an iteration; see StopCondition. May be null.
  bool (*stop)(const void* context);
  const void* stop_context;
};

enum class AttemptEnd {
  kConverged,
  kStationary,
  kImpatient,
  kIterations,
  kStopped,
};

struct Attempt {
  AttemptEnd end;
  int iterations;
  double energy;  // half the weighted squared error of the returned q
  // A column at a bound was pushed outwards at the returned q.
  bool pushed_at_limit;
};

// Memory of one attempt, 64-byte aligned, sized by the caller.
struct Workspace {
  double* node_rotation;     // 9 * node_count
  double* node_translation;  // 3 * node_count
  double* axes;              // 3 * axis_count
  double* body_bases;        // 9 * node_count, where touched
  uint8_t* touched;          // node_count, flags of RotationTouch
  double* jacobian;          // j_size
  double* residuals;         // 6 * task_count
  double* effectors;         // 3 * task_count
  GoalFrame* frames;         // kMaxGoalFrames * shaped_count
  GoalRows* goal_rows;       // shaped_count
  double* h;                 // h_size
  double* gradient;          // column_count
  double* step;              // column_count
  uint8_t* blocked;          // column_count
  double* best_positions;    // position_count
  // Out: errors of the returned q, squared; rotation as (2 sin(angle/2))^2.
  double* position_errors2;  // task_count
  double* rotation_errors2;  // task_count
};

// Improves `positions` in place; see LevenbergMarquardtSolver.
using AttemptFunction = Attempt (*)(const TreeLayout& tree,
                                    const TaskTarget* targets,
                                    const Settings& settings,
                                    const Workspace& workspace,
                                    double* positions);

namespace baseline {
Attempt Run(const TreeLayout&, const TaskTarget*, const Settings&,
            const Workspace&, double*);
}
namespace avx2 {
Attempt Run(const TreeLayout&, const TaskTarget*, const Settings&,
            const Workspace&, double*);
}
namespace avx512 {
Attempt Run(const TreeLayout&, const TaskTarget*, const Settings&,
            const Workspace&, double*);
}

}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_TREE_LAYOUT_H_
