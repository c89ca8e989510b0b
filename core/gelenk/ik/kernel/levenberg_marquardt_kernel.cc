// The inner loop of LevenbergMarquardtSolver, compiled once per level of the
// instruction set: GELENK_KERNEL_LEVEL names the level, GELENK_KERNEL_LANES is
// its vector width in doubles.
//
// Only plain arrays and functions of this file (and of rotation_bounds.h and
// goal_rows.h, out of line): an inline function of a library that was emitted
// here with a higher level could be picked by the linker for everybody.
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/descent.h"
#include "gelenk/ik/kernel/rotation_bounds.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// Bounds of a turn and limits of a rotation are brought together in so many
// rounds; where they meet at a slant each leaves a part of the gap before.
constexpr int kBoundRounds = 16;

constexpr int kLanes = GELENK_KERNEL_LANES;
static_assert(kRowAlignment % kLanes == 0);
typedef double Pack __attribute__((vector_size(8 * kLanes), may_alias));

constexpr double kDampingPerEnergy = 1e-2;

GELENK_INLINE double Min(double a, double b) { return a < b ? a : b; }
GELENK_INLINE double Max(double a, double b) { return a > b ? a : b; }
GELENK_INLINE double Abs(double a) { return a < 0 ? -a : a; }

GELENK_INLINE void Copy(const double* from, double* to, int count) {
  for (int i = 0; i < count; ++i) to[i] = from[i];
}

// Minimax polynomials of the Cephes library's kind on [-pi/4, pi/4] with a
// three-part reduction; within 1 ulp for |x| up to 1e5, beyond that the
// compiler's own.
GELENK_INLINE void SineCosine(double x, double* sine, double* cosine) {
  if (Abs(x) > 1e5) {
    *sine = __builtin_sin(x);
    *cosine = __builtin_cos(x);
    return;
  }
  const double k = __builtin_rint(x * 6.36619772367581343076e-01);
  double r = x - k * 1.57079632673412561417e+00;
  r -= k * 6.07710050630396597660e-11;
  r -= k * 2.02226624879595063154e-21;
  const double z = r * r;
  const double s =
      r + r * z *
              (-1.66666666666666324348e-01 +
               z * (8.33333333332248946124e-03 +
                    z * (-1.98412698298579493134e-04 +
                         z * (2.75573137070700676789e-06 +
                              z * (-2.50507602534068634195e-08 +
                                   z * 1.58969099521155010221e-10)))));
  const double c =
      1.0 - 0.5 * z +
      z * z *
          (4.16666666666666019037e-02 +
           z * (-1.38888888888741095749e-03 +
                z * (2.48015872894767294178e-05 +
                     z * (-2.75573143513906633035e-07 +
                          z * (2.08757232129817482790e-09 +
                               z * -1.13596475577881948265e-11)))));
  const int quadrant = static_cast<int>(k) & 3;
  const double a = (quadrant & 1) ? c : s;
  const double b = (quadrant & 1) ? s : c;
  *sine = (quadrant & 2) ? -a : a;
  *cosine = ((quadrant + 1) & 2) ? -b : b;
}

GELENK_INLINE void Multiply(const double* a, const double* b, double* out) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out[3 * i + j] =
          a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
    }
  }
}

// point + rotation * v
GELENK_INLINE void Transform(const double* rotation, const double* point,
                             const double* v, double* out) {
  for (int i = 0; i < 3; ++i) {
    out[i] = point[i] + rotation[3 * i] * v[0] + rotation[3 * i + 1] * v[1] +
             rotation[3 * i + 2] * v[2];
  }
}

GELENK_INLINE void MatrixFromQuaternion(const double* q, double* m) {
  const double x2 = q[0] + q[0], y2 = q[1] + q[1], z2 = q[2] + q[2];
  const double xx = q[0] * x2, yy = q[1] * y2, zz = q[2] * z2;
  const double xy = q[0] * y2, xz = q[0] * z2, yz = q[1] * z2;
  const double wx = q[3] * x2, wy = q[3] * y2, wz = q[3] * z2;
  m[0] = 1 - (yy + zz), m[1] = xy - wz, m[2] = xz + wy;
  m[3] = xy + wz, m[4] = 1 - (xx + zz), m[5] = yz - wx;
  m[6] = xz - wy, m[7] = yz + wx, m[8] = 1 - (xx + yy);
}

GELENK_INLINE void TurnAboutZ(const double* a, double angle, double* out) {
  double s, c;
  SineCosine(angle, &s, &c);
  for (int i = 0; i < 3; ++i) {
    const double x = a[3 * i], y = a[3 * i + 1];
    out[3 * i] = x * c + y * s;
    out[3 * i + 1] = y * c - x * s;
    out[3 * i + 2] = a[3 * i + 2];
  }
}

// Column `column` of rotation `m` as a world axis.
GELENK_INLINE void StoreAxis(const double* m, int column, double* axis) {
  for (int i = 0; i < 3; ++i) axis[i] = m[3 * i + column];
}

class Solver {
 public:
  Solver(const TreeLayout& tree, const TaskTarget* targets,
         const Settings& settings, const Workspace& workspace,
         double* positions)
      : tree_(tree),
        targets_(targets),
        settings_(settings),
        work_(workspace),
        q_(positions) {}

  double Evaluate() {
    ForwardPass();
    posture_energy_ = 0;
    for (int i = 0; i < settings_.posture_count; ++i) {
      posture_energy_ += PostureEnergy(settings_.posture[i]);
    }
    return Residuals() + posture_energy_;
  }

  double PostureEnergy() const { return posture_energy_; }
  double LastMove() const { return last_move_; }

  bool IsWithinTolerance() const {
    for (int t = 0; t < tree_.task_count; ++t) {
      // So written that NaN is not within.
      if (!(work_.position_errors2[t] <= settings_.position_tolerance2 &&
            work_.rotation_errors2[t] <= settings_.rotation_tolerance2)) {
        return false;
      }
    }
    return true;
  }

  void KeepBest() { Copy(q_, work_.best_positions, tree_.position_count); }
  void TakeBest() { Copy(work_.best_positions, q_, tree_.position_count); }

  // Weighted Jacobians of all tasks, six padded rows each, the gradient, and
  // which columns are blocked.
  bool Linearize() {
    for (int c = 0; c < tree_.column_count; ++c) work_.gradient[c] = 0;
    double* j = work_.jacobian;
    for (int t = 0; t < tree_.task_count; ++t) {
      const Task& task = tree_.tasks[t];
      const int stride = PaddedRow(task.path_size);
      if (targets_[t].active && task.shape == GoalShape::kPose) {
        LinearizeTask(t, task, j, stride);
      } else if (targets_[t].active) {
        LinearizeShaped(t, task, j, stride);
      }
      j += 6 * stride;
    }
    for (int i = 0; i < settings_.posture_count; ++i) PullBack(i);
    return BlockColumns();
  }

  void Step(double damping) {
    Accumulate();
    for (int i = 0; i < settings_.posture_count; ++i) Stiffen(i);
    Factorize(damping);
    Solve();
    Move();
  }

 private:
  void ForwardPass() {
    for (int i = 0; i < tree_.node_count; ++i) {
      const Node& node = tree_.nodes[i];
      const bool is_root = node.parent < 0;
      const double* parent_rotation =
          is_root ? settings_.base_rotation
                  : work_.node_rotation + 9 * node.parent;
      const double* parent_translation =
          is_root ? settings_.base_translation
                  : work_.node_translation + 3 * node.parent;
      double rest[9];
      const double* world_from_rest = parent_rotation;
      if (!node.offset_is_translation) {
        Multiply(parent_rotation, node.parent_from_rest_rotation, rest);
        world_from_rest = rest;
      }
      double* translation = work_.node_translation + 3 * i;
      Transform(parent_rotation, parent_translation,
                node.parent_from_rest_translation, translation);
      MoveNode(i, node, world_from_rest, translation);
    }
  }

  GELENK_INLINE void MoveNode(int i, const Node& node, const double* rest,
                              double* translation) {
    double* rotation = work_.node_rotation + 9 * i;
    double* axis = work_.axes + 3 * node.axis;
    const double* q = q_ + node.position;
    switch (node.type) {
      case NodeType::kRevolute:
        StoreAxis(rest, 2, axis);
        TurnAboutZ(rest, node.multiplier * q[0] + node.offset, rotation);
        break;
      case NodeType::kPrismatic: {
        StoreAxis(rest, 2, axis);
        const double d = node.multiplier * q[0] + node.offset;
        for (int k = 0; k < 3; ++k) translation[k] += d * axis[k];
        Copy(rest, rotation, 9);
        break;
      }
      case NodeType::kSpherical:
        Turn(i, node, rest, q, rotation, axis);
        break;
      case NodeType::kPlanar:
        for (int k = 0; k < 3; ++k) StoreAxis(rest, k, axis + 3 * k);
        for (int k = 0; k < 3; ++k) {
          translation[k] += q[0] * axis[k] + q[1] * axis[3 + k];
        }
        TurnAboutZ(rest, q[2], rotation);
        break;
      case NodeType::kFree:
        for (int k = 0; k < 3; ++k) StoreAxis(rest, k, axis + 3 * k);
        for (int k = 0; k < 3; ++k) {
          translation[k] +=
              q[0] * axis[k] + q[1] * axis[3 + k] + q[2] * axis[6 + k];
        }
        Turn(i, node, rest, q + 3, rotation, axis + 9);
        break;
    }
  }

  // A rotation by quaternion `q`; its axes are the body's, or where it touches
  // its limits those in which the limits are a box.
  GELENK_INLINE void Turn(int i, const Node& node, const double* rest,
                          const double* q, double* rotation, double* axis) {
    double motion[9];
    MatrixFromQuaternion(q, motion);
    Multiply(rest, motion, rotation);
    work_.touched[i] = 0;
    if (node.limits_rotation && !IsWellInside(tree_.rotation_limits[i], q)) {
      double* basis = work_.body_bases + 9 * i;
      work_.touched[i] = TouchRotationLimit(tree_.rotation_limits[i], q, basis);
      if (work_.touched[i] != 0) {
        double turned[9];
        Multiply(rotation, basis, turned);
        for (int k = 0; k < 3; ++k) StoreAxis(turned, k, axis + 3 * k);
        return;
      }
    }
    for (int k = 0; k < 3; ++k) StoreAxis(rotation, k, axis + 3 * k);
  }

  // Residuals of all tasks in world axes: the way to the target, and
  // 2 sin(angle/2) about the axis to it. Returns half their weighted square.
  double Residuals() {
    double energy = 0;
    for (int t = 0; t < tree_.task_count; ++t) {
      const Task& task = tree_.tasks[t];
      const TaskTarget& target = targets_[t];
      double* e = work_.residuals + 6 * t;
      work_.position_errors2[t] = 0;
      work_.rotation_errors2[t] = 0;
      if (!target.active) continue;
      if (task.shape != GoalShape::kPose) {
        energy += ShapedResidual(t, task);
        continue;
      }
      const double* rotation = task.node < 0
                                   ? settings_.base_rotation
                                   : work_.node_rotation + 9 * task.node;
      const double* translation = task.node < 0
                                      ? settings_.base_translation
                                      : work_.node_translation + 3 * task.node;
      double* tip = work_.effectors + 3 * t;
      Transform(rotation, translation, task.node_from_effector_translation,
                tip);
      if (task.row_begin == 0) {
        double sum = 0;
        for (int k = 0; k < 3; ++k) {
          e[k] = target.world_translation[k] - tip[k];
          sum += target.row_counts[k] * e[k] * e[k];
        }
        work_.position_errors2[t] = sum;
      }
      if (task.row_end == 6 && target.row_scale[3] == 0) {
        for (int k = 3; k < 6; ++k) e[k] = 0;
      } else if (task.row_end == 6) {
        double turned[9];
        Multiply(rotation, task.node_from_effector_rotation, turned);
        work_.rotation_errors2[t] =
            RotationResidual(target.world_rotation, turned, e + 3);
      }
      for (int k = task.row_begin; k < task.row_end; ++k) {
        e[k] *= target.row_scale[k];
        energy += 0.5 * e[k] * e[k];
      }
    }
    return energy;
  }

  // Of one joint. A rotation's is 4 (1 - cos(angle / 2)), whose gradient is the
  // rotation vector below.
  GELENK_INLINE double PostureEnergy(const PostureTerm& term) const {
    if (!term.rotation) {
      const double way = term.target[0] - q_[term.position];
      return 0.5 * term.weight * way * way;
    }
    double turn[4];
    BodyTurn(term, turn);
    const double sine2 =
        turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2];
    return term.weight * 4 * sine2 / (1 + turn[3]);
  }

  // The rotation from where a joint is to its posture, in its body frame, by
  // the shorter way: sin(angle / 2) times the axis, cos(angle / 2).
  GELENK_INLINE void BodyTurn(const PostureTerm& term, double* turn) const {
    const double* q = q_ + term.position;
    const double* t = term.target;
    turn[0] = q[3] * t[0] - t[3] * q[0] - (q[1] * t[2] - q[2] * t[1]);
    turn[1] = q[3] * t[1] - t[3] * q[1] - (q[2] * t[0] - q[0] * t[2]);
    turn[2] = q[3] * t[2] - t[3] * q[2] - (q[0] * t[1] - q[1] * t[0]);
    turn[3] = q[0] * t[0] + q[1] * t[1] + q[2] * t[2] + q[3] * t[3];
    if (turn[3] >= 0) return;
    for (int k = 0; k < 4; ++k) turn[k] = -turn[k];
  }

  // The gradient of a posture, in the basis in which the joint moves.
  void PullBack(int i) {
    const PostureTerm& term = settings_.posture[i];
    double* g = work_.gradient + term.column;
    if (!term.rotation) {
      g[0] += term.weight * (term.target[0] - q_[term.position]);
      return;
    }
    double turn[4];
    BodyTurn(term, turn);
    const int node = tree_.columns[term.column].node;
    const double* basis = work_.body_bases + 9 * node;
    for (int k = 0; k < 3; ++k) {
      const double along = work_.touched[node] == 0
                               ? turn[k]
                               : basis[k] * turn[0] + basis[3 + k] * turn[1] +
                                     basis[6 + k] * turn[2];
      g[k] += 2 * term.weight * along;
    }
  }

  // Its part of H: diagonal but where a rotation's basis is not orthogonal.
  void Stiffen(int i) {
    const PostureTerm& term = settings_.posture[i];
    const int count = term.rotation ? 3 : 1;
    for (int k = 0; k < count; ++k) {
      const Column& column = tree_.columns[term.column + k];
      double* row = work_.h + column.row;
      const bool touched = term.rotation && work_.touched[column.node] != 0;
      if (!touched) {
        row[column.depth] += term.weight;
        continue;
      }
      const double* basis = work_.body_bases + 9 * column.node;
      for (int m = 0; m <= k; ++m) {
        const double product = basis[k] * basis[m] +
                               basis[3 + k] * basis[3 + m] +
                               basis[6 + k] * basis[6 + m];
        row[column.depth - k + m] += term.weight * product;
      }
    }
  }

  static GELENK_INLINE double RotationResidual(const double* to,
                                               const double* from, double* e) {
    // d = to * from^T
    double d[9];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        d[3 * i + j] = to[3 * i] * from[3 * j] +
                       to[3 * i + 1] * from[3 * j + 1] +
                       to[3 * i + 2] * from[3 * j + 2];
      }
    }
    const double trace1 = 1 + d[0] + d[4] + d[8];  // 4 cos^2(angle/2)
    if (trace1 > 1e-3) {
      const double scale = 1 / __builtin_sqrt(trace1);
      e[0] = (d[7] - d[5]) * scale;
      e[1] = (d[2] - d[6]) * scale;
      e[2] = (d[3] - d[1]) * scale;
      return e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
    }
    // Near half a turn: the axis comes from the largest diagonal element.
    const int i = d[0] >= d[4] && d[0] >= d[8] ? 0 : (d[4] >= d[8] ? 1 : 2);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double root = __builtin_sqrt(
        Max(1 + d[4 * i] - d[4 * j] - d[4 * k], 0));  // 2 |component i|
    const double sign = d[3 * k + j] < d[3 * j + k] ? -1 : 1;
    e[i] = sign * root;
    e[j] = sign * (d[3 * i + j] + d[3 * j + i]) / root;
    e[k] = sign * (d[3 * i + k] + d[3 * k + i]) / root;
    return e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  }

  // The same for goals of other shapes, and their rows.
  double ShapedResidual(int t, const Task& task) {
    const TaskTarget& target = targets_[t];
    GoalFrame* frames = work_.frames + kMaxGoalFrames * task.shaped;
    for (int f = 0; f < task.frame_count; ++f) {
      const TaskFrame& frame = tree_.frames[task.frame_begin + f];
      const bool on_base = frame.node < 0;
      const double* rotation = on_base ? settings_.base_rotation
                                       : work_.node_rotation + 9 * frame.node;
      const double* translation = on_base
                                      ? settings_.base_translation
                                      : work_.node_translation + 3 * frame.node;
      Multiply(rotation, frame.node_from_frame_rotation, frames[f].rotation);
      Transform(rotation, translation, frame.node_from_frame_translation,
                frames[f].translation);
    }
    GoalRows& rows = work_.goal_rows[task.shaped];
    LinearizeGoal(target, frames, rows);
    work_.position_errors2[t] = rows.position_error2;
    work_.rotation_errors2[t] = rows.rotation_error2;
    double* e = work_.residuals + 6 * t;
    double energy =
        target.row_scale[3] * target.row_scale[3] * rows.rotation_energy;
    for (int r = 0; r < task.row_end; ++r) {
      const bool translates = r < target.translation_rows;
      e[r] = rows.residual[r] * target.row_scale[translates ? r : 3];
      if (translates) energy += 0.5 * e[r] * e[r];
    }
    return energy;
  }

  GELENK_INLINE void AddColumn(const double* axis, const double* origin,
                               bool rotation, const double* tip, double scale,
                               const Task& task, double* j, int stride) {
    double column[6] = {axis[0], axis[1], axis[2], 0, 0, 0};
    if (rotation) {
      const double d[3] = {tip[0] - origin[0], tip[1] - origin[1],
                           tip[2] - origin[2]};
      column[0] = axis[1] * d[2] - axis[2] * d[1];
      column[1] = axis[2] * d[0] - axis[0] * d[2];
      column[2] = axis[0] * d[1] - axis[1] * d[0];
      column[3] = axis[0], column[4] = axis[1], column[5] = axis[2];
    }
    for (int r = task.row_begin; r < task.row_end; ++r) {
      j[r * stride] += scale * column[r];
    }
  }

  void LinearizeTask(int t, const Task& task, double* j, int stride) {
    const double* tip = work_.effectors + 3 * t;
    const TaskTarget& target = targets_[t];
    const PathColumn* path = tree_.path_columns + task.path_begin;
    for (int i = task.row_begin * stride; i < task.row_end * stride; ++i) {
      j[i] = 0;
    }
    for (int k = 0; k < task.path_size; ++k) {
      if (path[k].absent) continue;
      AddColumn(work_.axes + 3 * path[k].column,
                work_.node_translation + 3 * path[k].node, path[k].rotation,
                tip, 1, task, j + k, stride);
    }
    const PathFollower* followers = tree_.followers + task.follower_begin;
    for (int f = 0; f < task.follower_count; ++f) {
      AddColumn(work_.axes + 3 * followers[f].axis,
                work_.node_translation + 3 * followers[f].node,
                followers[f].rotation, tip, followers[f].multiplier, task,
                j + followers[f].place, stride);
    }
    const double* e = work_.residuals + 6 * t;
    for (int r = task.row_begin; r < task.row_end; ++r) {
      double* row = j + r * stride;
      for (int k = 0; k < task.path_size; ++k) {
        row[k] *= target.row_scale[r];
        work_.gradient[path[k].column] += row[k] * e[r];
      }
    }
  }

  // By way of the frames that the goal looks at.
  void LinearizeShaped(int t, const Task& task, double* j, int stride) {
    const TaskTarget& target = targets_[t];
    const PathColumn* path = tree_.path_columns + task.path_begin;
    for (int i = 0; i < task.row_end * stride; ++i) j[i] = 0;
    for (int k = 0; k < task.path_size; ++k) {
      if (path[k].absent) continue;
      AddShapedColumn(work_.axes + 3 * path[k].column, path[k].node,
                      path[k].rotation, 1, task, j + k, stride);
    }
    const PathFollower* followers = tree_.followers + task.follower_begin;
    for (int f = 0; f < task.follower_count; ++f) {
      AddShapedColumn(work_.axes + 3 * followers[f].axis, followers[f].node,
                      followers[f].rotation, followers[f].multiplier, task,
                      j + followers[f].place, stride);
    }
    const double* e = work_.residuals + 6 * t;
    for (int r = 0; r < task.row_end; ++r) {
      const double scale =
          target.row_scale[r < target.translation_rows ? r : 3];
      double* row = j + r * stride;
      for (int k = 0; k < task.path_size; ++k) {
        row[k] *= scale;
        work_.gradient[path[k].column] += row[k] * e[r];
      }
    }
  }

  GELENK_INLINE void AddShapedColumn(const double* axis, int node,
                                     bool rotation, double scale,
                                     const Task& task, double* j, int stride) {
    const GoalFrame* frames = work_.frames + kMaxGoalFrames * task.shaped;
    const GoalRows& rows = work_.goal_rows[task.shaped];
    const double* origin = work_.node_translation + 3 * node;
    for (int f = 0; f < task.frame_count; ++f) {
      if (node > tree_.frames[task.frame_begin + f].node) continue;
      double motion[6] = {axis[0], axis[1], axis[2], 0, 0, 0};
      if (rotation) {
        const double* tip = frames[f].translation;
        const double d[3] = {tip[0] - origin[0], tip[1] - origin[1],
                             tip[2] - origin[2]};
        motion[0] = axis[1] * d[2] - axis[2] * d[1];
        motion[1] = axis[2] * d[0] - axis[0] * d[2];
        motion[2] = axis[0] * d[1] - axis[1] * d[0];
        motion[3] = axis[0], motion[4] = axis[1], motion[5] = axis[2];
      }
      for (int r = 0; r < task.row_end; ++r) {
        const double* row = rows.rows[f][r];
        double sum = 0;
        for (int i = 0; i < 6; ++i) sum += row[i] * motion[i];
        j[r * stride] += scale * sum;
      }
    }
  }

  // Marks the columns that sit at a bound and are pushed outwards; they do not
  // move in this step. Returns whether any is pushed with force.
  bool BlockColumns() {
    double largest = 0;
    double pushed = 0;
    for (int c = 0; c < tree_.column_count; ++c) {
      const Column& column = tree_.columns[c];
      double& g = work_.gradient[c];
      bool blocked = false;
      if (column.position >= 0) {
        const double value = q_[column.position];
        const double lower = settings_.lower[c], upper = settings_.upper[c];
        blocked = (value <= lower && g < 0) || (value >= upper && g > 0) ||
                  lower == upper;
      } else if (work_.touched[column.node] != 0) {
        blocked = IsBlockedRotation(column, c, g);
      }
      work_.blocked[c] = blocked;
      if (blocked) {
        pushed = Max(pushed, Abs(g));
        g = 0;
      } else {
        largest = Max(largest, Abs(g));
      }
    }
    return pushed > 0 && pushed > 10 * largest;
  }

  GELENK_INLINE bool IsBlockedRotation(const Column& column, int c,
                                       double g) const {
    const Node& node = tree_.nodes[column.node];
    const int first = node.axis + (node.type == NodeType::kFree ? 3 : 0);
    const uint8_t touched = work_.touched[column.node];
    switch (c - first) {
      case 0:
        return (touched & kConeIsPoint) || ((touched & kTouchesCone) && g > 0);
      case 1:
        return touched & kConeIsPoint;
      default:
        return ((touched & kTouchesTwistLower) && g < 0) ||
               ((touched & kTouchesTwistUpper) && g > 0);
    }
  }

  // H += J^T J over all tasks, on the packed rows.
  void Accumulate() {
    const Pack zero = {};
    Pack* h = reinterpret_cast<Pack*>(work_.h);
    for (int i = 0; i < tree_.h_size / kLanes; ++i) h[i] = zero;
    const double* j = work_.jacobian;
    for (int t = 0; t < tree_.task_count; ++t) {
      const Task& task = tree_.tasks[t];
      const int stride = PaddedRow(task.path_size);
      if (targets_[t].active) {
        const double* rows = j + task.row_begin * stride;
        switch (task.row_end - task.row_begin) {
          case 6:
            AccumulateRows<6>(task, rows, stride);
            break;
          case 3:
            AccumulateRows<3>(task, rows, stride);
            break;
          default:
            for (int r = task.row_begin; r < task.row_end; ++r) {
              AccumulateRows<1>(task, j + r * stride, stride);
            }
        }
      }
      j += 6 * stride;
    }
  }

  template <int kRows>
  GELENK_INLINE void AccumulateRows(const Task& task, const double* j,
                                    int stride) {
    const PathColumn* path = tree_.path_columns + task.path_begin;
    for (int k = 0; k < task.path_size; ++k) {
      const int c = path[k].column;
      if (work_.blocked[c]) continue;
      Pack* h = reinterpret_cast<Pack*>(work_.h + tree_.columns[c].row);
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

  // H + damping -> L^T D L in place, leaf first; the diagonal holds 1/D.
  void Factorize(double damping) {
    for (int c = tree_.column_count - 1; c >= 0; --c) {
      const Column& column = tree_.columns[c];
      double* row = work_.h + column.row;
      const int depth = column.depth;
      if (work_.blocked[c]) {
        for (int m = 0; m < depth; ++m) row[m] = 0;
        row[depth] = 1;
        continue;
      }
      const double inverse = 1 / (row[depth] + damping * column.stiffness);
      row[depth] = inverse;
      const PathColumn* ancestors = tree_.path_columns + column.ancestors;
      const Pack* source = reinterpret_cast<const Pack*>(row);
      for (int m = 0; m < depth; ++m) {
        const int a = ancestors[m].column;
        if (work_.blocked[a]) {
          row[m] = 0;
          continue;
        }
        const double scale = row[m] * inverse;
        Pack* h = reinterpret_cast<Pack*>(work_.h + tree_.columns[a].row);
        for (int v = 0; v <= m / kLanes; ++v) h[v] -= scale * source[v];
      }
      for (int m = 0; m < depth; ++m) row[m] *= inverse;
    }
  }

  // step = (L^T D L)^-1 gradient.
  void Solve() {
    double* x = work_.step;
    Copy(work_.gradient, x, tree_.column_count);
    for (int c = tree_.column_count - 1; c >= 0; --c) {
      const Column& column = tree_.columns[c];
      const double* row = work_.h + column.row;
      const PathColumn* ancestors = tree_.path_columns + column.ancestors;
      const double value = x[c];
      for (int m = 0; m < column.depth; ++m) {
        x[ancestors[m].column] -= row[m] * value;
      }
    }
    for (int c = 0; c < tree_.column_count; ++c) {
      const Column& column = tree_.columns[c];
      const double* row = work_.h + column.row;
      const PathColumn* ancestors = tree_.path_columns + column.ancestors;
      double value = x[c] * row[column.depth];
      for (int m = 0; m < column.depth; ++m) {
        value -= row[m] * x[ancestors[m].column];
      }
      x[c] = work_.blocked[c] ? 0 : value;
    }
  }

  void Move() {
    double largest = 0;
    for (int c = 0; c < tree_.column_count; ++c) {
      largest = Max(largest, Abs(work_.step[c]));
    }
    const double scale = largest > kMaxStep ? kMaxStep / largest : 1;
    last_move_ = scale * largest;
    for (int c = 0; c < tree_.column_count; ++c) {
      const Column& column = tree_.columns[c];
      if (column.position < 0) continue;
      const double value = q_[column.position] + scale * work_.step[c];
      q_[column.position] =
          Min(Max(value, settings_.lower[c]), settings_.upper[c]);
    }
    for (int i = 0; i < tree_.node_count; ++i) {
      const Node& node = tree_.nodes[i];
      if (node.type == NodeType::kSpherical) {
        StepRotation(i, scale, work_.step + node.axis, q_ + node.position);
      } else if (node.type == NodeType::kFree) {
        StepRotation(i, scale, work_.step + node.axis + 3,
                     q_ + node.position + 3);
      }
    }
  }

  GELENK_INLINE void StepRotation(int i, double scale, const double* step,
                                  double* q) {
    double w[3] = {scale * step[0], scale * step[1], scale * step[2]};
    if (work_.touched[i] != 0) {
      const double local[3] = {w[0], w[1], w[2]};
      const double zero[3] = {0, 0, 0};
      Transform(work_.body_bases + 9 * i, zero, local, w);
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
    const double x = s * w[0], y = s * w[1], z = s * w[2];
    const double out[4] = {q[3] * x + q[0] * c + q[1] * z - q[2] * y,
                           q[3] * y + q[1] * c + q[2] * x - q[0] * z,
                           q[3] * z + q[2] * c + q[0] * y - q[1] * x,
                           q[3] * c - q[0] * x - q[1] * y - q[2] * z};
    const double inverse =
        1 / __builtin_sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] +
                           out[3] * out[3]);
    for (int k = 0; k < 4; ++k) q[k] = out[k] * inverse;
    // The nearest rotation that keeps both bounds, by turns; limits come last,
    // and hold whatever else was asked for.
    for (int round = 0; round < kBoundRounds; ++round) {
      const bool cut = settings_.turn_start != nullptr &&
                       KeepTurn(i, settings_.turn_start + (q - q_), q);
      if (round > 0 && !cut) break;
      if (!tree_.nodes[i].limits_rotation ||
          IsWellInside(tree_.rotation_limits[i], q)) {
        break;
      }
      ClampToRotationLimit(tree_.rotation_limits[i], q);
    }
  }

  // Cuts the turn from `start` to `q` where it is larger than its bound; true
  // when it was.
  GELENK_INLINE bool KeepTurn(int i, const double* start, double* q) {
    const double cosine = settings_.turn_cosine[i];
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
        settings_.turn_sine[i] / __builtin_sqrt(Max(length2, 1e-300));
    const double along = w < 0 ? -cosine : cosine;
    for (int k = 0; k < 4; ++k) q[k] = along * start[k] + sine * across[k];
    return true;
  }

  const TreeLayout& tree_;
  const TaskTarget* const targets_;
  const Settings& settings_;
  const Workspace& work_;
  double* const q_;
  double posture_energy_ = 0;
  double last_move_ = 0;
};

}  // namespace

Attempt Run(const TreeLayout& tree, const TaskTarget* targets,
            const Settings& settings, const Workspace& workspace,
            double* positions) {
  Solver solver(tree, targets, settings, workspace, positions);
  return Descend(solver, settings, kDampingPerEnergy);
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
