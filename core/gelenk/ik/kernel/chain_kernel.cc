// The inner loop of LevenbergMarquardtSolver for serial chains with one
// position goal (see chain_layout.h), compiled once per level of the
// instruction set: GELENK_KERNEL_LEVEL names the level, GELENK_KERNEL_LANES is
// its vector width in doubles.
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_math.h"
#include "gelenk/ik/kernel/descent.h"
#include "gelenk/ik/kernel/rotation_bounds.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr int kWidth = GELENK_KERNEL_LANES;
static_assert(kChainLanes % kWidth == 0);
using Vector = Lanes<kWidth>;
using Pack = Vector::Pack;
using Mask = Vector::Mask;
constexpr int kRows = kWidth < 4 ? kWidth : 4;
using Rows = Lanes<kRows>::Pack;

// With as much damping a straight chain bends at all its joints rather than
// throws some of them round; ten times less takes more iterations and restarts.
constexpr double kDampingPerEnergy = 1e-1;
// Times that a step is taken anew for coordinates that hit their limits.
constexpr int kActiveSetPasses = 2;

// Places in the record of a step.
enum ScalarPlace {
  kAngle,
  kLower,
  kUpper,
  kBestAngle,
  kWeight,
  kChange,
  kAxis,  // 3; of its Jacobian once that is known
  kOrigin = kAxis + 3,
  kScalarEnd = kOrigin + 3,
};
static_assert(kScalarEnd == kScalarRecord);
enum SphericalPlace {
  kQuaternion,
  kBestQuaternion = kQuaternion + 4,
  kWeights = kBestQuaternion + 4,
  kChanges = kWeights + 3,
  kAxes = kChanges + 3,
  kCenter = kAxes + 9,
  kBasis = kCenter + 3,
  kSphericalEnd = kBasis + 9,
};
static_assert(kSphericalEnd == kSphericalRecord);

// The numbers of some lanes, `part` on.
GELENK_INLINE Pack Get(const LaneNumbers* numbers, int place, int part) {
  return Vector::Load(numbers[place] + part);
}
GELENK_INLINE void Put(LaneNumbers* numbers, int place, int part,
                       const Pack& pack) {
  Vector::Store(pack, numbers[place] + part);
}

class ChainSolver {
 public:
  ChainSolver(const ChainLayout& chain, const TaskTarget& target,
              const Settings& settings, const ChainWorkspace& workspace,
              double* positions)
      : chain_(chain),
        target_(target),
        settings_(settings),
        work_(workspace),
        q_(positions),
        part_end_((chain.lane_count + kWidth - 1) / kWidth * kWidth) {}

  Attempt Run() {
    Load();
    Attempt attempt = {AttemptEnd::kConverged, 0, 0, false};
    *work_.position_error2 = 0;
    if (target_.active) attempt = Descend(*this, settings_, kDampingPerEnergy);
    Save();
    return attempt;
  }

  // Where everything is; returns half the weighted squared error.
  double Evaluate() {
    if (!MoveSegments<false>()) MoveSegments<true>();
    return JoinSegments();
  }

  // Chains with a posture go to the tree's kernel.
  double PostureEnergy() const { return 0; }
  double LastMove() const { return 0; }

  bool IsWithinTolerance() const {
    // So written that NaN is not within.
    return *work_.position_error2 <= settings_.position_tolerance2;
  }

  void KeepBest() {
    ForEachNumber([](LaneNumbers* record, int q, int best, int part) {
      Put(record, best, part, Get(record, q, part));
    });
  }

  void TakeBest() {
    ForEachNumber([](LaneNumbers* record, int q, int best, int part) {
      Put(record, q, part, Get(record, best, part));
    });
    for (int s = 0; s < chain_.step_count; ++s) {
      const ChainStep& step = chain_.steps[s];
      if (step.limits_rotation) TouchLimits(step, RecordOf(step));
    }
  }

  // Jacobians, what is free to move, and J S^-1 J^T. Returns whether something
  // is pushed against a limit.
  bool Linearize() {
    Pack sum[6] = {};
    double force[3];
    for (int k = 0; k < 3; ++k) force[k] = target_.row_scale[k] * error_[k];
    Pack pushed = {}, largest = {};
    for (int part = 0; part < part_end_; part += kWidth) {
      Pack e[3], tip[3], m[6] = {};
      ToSegments(force, part, e);
      TipInSegments(part, tip);
      for (int s = 0; s < chain_.step_count; ++s) {
        const ChainStep& step = chain_.steps[s];
        LaneNumbers* record = RecordOf(step);
        if (step.type == NodeType::kSpherical) {
          LinearizeSpherical(step, record, part, tip, e, m, &pushed, &largest);
        } else {
          LinearizeScalar(step, record, part, tip, e, m, &pushed, &largest);
        }
      }
      AddToWorld(m, part, sum);
    }
    for (int k = 0; k < 6; ++k) normal_[k] = Vector::Sum(sum[k]);
    const double most = Vector::Largest(pushed);
    return most > 0 && most > 10 * Vector::Largest(largest);
  }

  // Takes the damped step. Where it would leave the limits, the coordinates
  // that hit them stop there, and the others make up for it.
  void Step(double damping) {
    double force[3];
    SolveStep(damping, error_, force);
    double excess;
    const double longest = FindChanges(force, &excess);
    const double scale = longest > kMaxStep ? kMaxStep / longest : 1;
    if (scale == 1 && excess > 0) {
      double left[3] = {error_[0], error_[1], error_[2]};
      for (int pass = 0; pass < kActiveSetPasses && excess > 0; ++pass) {
        StopAtLimits(left);
        SolveStep(damping, left, force);
        FindChanges(force, &excess);
      }
    }
    Move(scale);
  }

 private:
  LaneNumbers* RecordOf(const ChainStep& step) const {
    return reinterpret_cast<LaneNumbers*>(work_.records) + step.record;
  }

  // From q to the records. Lanes without a node get a number that moves
  // nothing.
  void Load() {
    for (int s = 0; s < chain_.step_count; ++s) {
      const ChainStep& step = chain_.steps[s];
      LaneNumbers* record = RecordOf(step);
      const bool spherical = step.type == NodeType::kSpherical;
      for (int part = 0; part < part_end_; part += kWidth) {
        const Mask used = Get(step.compliance, 0, part) > 0;
        if (spherical) {
          for (int k = 0; k < 4; ++k) {
            const Pack q = Vector::Gather(q_ + k, step.position + part);
            const Pack still = Vector::All(k == 3);
            Put(record, kQuaternion + k, part, used ? q : still);
          }
          continue;
        }
        const Pack q = Vector::Gather(q_, step.position + part);
        const Pack still = {};
        const Pack unbounded = Vector::All(__builtin_inf());
        const int* columns = step.column + part;
        const Pack lower = Vector::Gather(settings_.lower, columns);
        const Pack upper = Vector::Gather(settings_.upper, columns);
        Put(record, kAngle, part, used ? q : still);
        Put(record, kLower, part, used ? lower : -unbounded);
        Put(record, kUpper, part, used ? upper : unbounded);
      }
      if (step.limits_rotation) {
        TouchLimits(step, record);
      } else if (spherical) {
        for (int node : step.node) {
          if (node >= 0) work_.touched[node] = 0;
        }
      }
    }
  }

  // And back.
  void Save() const {
    for (int s = 0; s < chain_.step_count; ++s) {
      const ChainStep& step = chain_.steps[s];
      const LaneNumbers* record = RecordOf(step);
      const int numbers = step.type == NodeType::kSpherical ? 4 : 1;
      for (int lane = 0; lane < kChainLanes; ++lane) {
        if (step.node[lane] < 0) continue;
        double* q = q_ + step.position[lane];
        for (int k = 0; k < numbers; ++k) q[k] = record[k][lane];
      }
    }
  }

  template <typename Visit>
  GELENK_INLINE void ForEachNumber(Visit visit) {
    for (int s = 0; s < chain_.step_count; ++s) {
      LaneNumbers* record = RecordOf(chain_.steps[s]);
      const bool spherical = chain_.steps[s].type == NodeType::kSpherical;
      for (int part = 0; part < part_end_; part += kWidth) {
        if (!spherical) {
          visit(record, kAngle, kBestAngle, part);
          continue;
        }
        for (int k = 0; k < 4; ++k) {
          visit(record, kQuaternion + k, kBestQuaternion + k, part);
        }
      }
    }
  }

  // Which limits each rotation touches, and the axes in which they are a box.
  void TouchLimits(const ChainStep& step, LaneNumbers* record) {
    for (int lane = 0; lane < kChainLanes; ++lane) {
      double basis[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
      if (step.node[lane] >= 0) {
        uint8_t& touched = work_.touched[step.node[lane]];
        touched = 0;
        if (step.limited[lane]) {
          const RotationLimit& limit = chain_.rotation_limits[step.node[lane]];
          double q[4];
          for (int k = 0; k < 4; ++k) q[k] = record[kQuaternion + k][lane];
          if (!IsWellInside(limit, q)) {
            touched = TouchRotationLimit(limit, q, basis);
          }
        }
      }
      for (int k = 0; k < 9; ++k) record[kBasis + k][lane] = basis[k];
    }
  }

  void ClampRotations(const ChainStep& step, LaneNumbers* record) {
    for (int lane = 0; lane < kChainLanes; ++lane) {
      if (!step.limited[lane]) continue;
      const RotationLimit& limit = chain_.rotation_limits[step.node[lane]];
      double q[4];
      for (int k = 0; k < 4; ++k) q[k] = record[kQuaternion + k][lane];
      if (IsWellInside(limit, q)) continue;
      ClampToRotationLimit(limit, q);
      for (int k = 0; k < 4; ++k) record[kQuaternion + k][lane] = q[k];
    }
  }

  // Each segment in the frame that it starts from. False when an angle is too
  // large for the vectorised sine.
  template <bool kAnyAngle>
  bool MoveSegments() {
    Pack largest_angle = {};
    for (int part = 0; part < part_end_; part += kWidth) {
      Pack rotation[9], origin[3];
      for (int k = 0; k < 9; ++k) {
        rotation[k] = Get(chain_.steps[0].rotation, k, part);
      }
      for (int k = 0; k < 3; ++k) {
        origin[k] = Get(chain_.steps[0].translation, k, part);
      }
      for (int s = 0; s < chain_.step_count; ++s) {
        const ChainStep& step = chain_.steps[s];
        LaneNumbers* record = RecordOf(step);
        if (s > 0) ToRest(step, part, rotation, origin);
        if (step.type == NodeType::kRevolute) {
          const Pack angle = Get(record, kAngle, part);
          largest_angle = Vector::Max(largest_angle, Vector::Abs(angle));
          TurnAboutZ<kAnyAngle>(angle, record, part, rotation, origin);
        } else if (step.type == NodeType::kPrismatic) {
          SlideAlongZ(record, part, rotation, origin);
        } else {
          TurnByQuaternion(step, record, part, rotation, origin);
        }
      }
      for (int k = 0; k < 9; ++k) Put(segment_rotation_, k, part, rotation[k]);
      for (int k = 0; k < 3; ++k) Put(segment_end_, k, part, origin[k]);
    }
    return Vector::Largest(largest_angle) <= kLargestAngle;
  }

  // From the frame of the node before to that of this one at rest.
  static GELENK_INLINE void ToRest(const ChainStep& step, int part,
                                   Pack* rotation, Pack* origin) {
    Pack offset[3];
    for (int k = 0; k < 3; ++k) offset[k] = Get(step.translation, k, part);
    AddTransformed(rotation, offset, origin);
    if (step.offset_is_translation) return;
    Pack rest[9], turned[9];
    for (int k = 0; k < 9; ++k) rest[k] = Get(step.rotation, k, part);
    Multiply(rotation, rest, turned);
    for (int k = 0; k < 9; ++k) rotation[k] = turned[k];
  }

  template <bool kAnyAngle>
  static GELENK_INLINE void TurnAboutZ(const Pack& angle, LaneNumbers* record,
                                       int part, Pack* rotation,
                                       const Pack* origin) {
    Pack sine, cosine;
    if (kAnyAngle) {
      for (int lane = 0; lane < kWidth; ++lane) {
        sine[lane] = __builtin_sin(angle[lane]);
        cosine[lane] = __builtin_cos(angle[lane]);
      }
    } else {
      Vector::SineCosine(angle, &sine, &cosine);
    }
    for (int k = 0; k < 3; ++k) {
      Put(record, kAxis + k, part, rotation[3 * k + 2]);
      Put(record, kOrigin + k, part, origin[k]);
      const Pack x = rotation[3 * k], y = rotation[3 * k + 1];
      rotation[3 * k] = x * cosine + y * sine;
      rotation[3 * k + 1] = y * cosine - x * sine;
    }
  }

  static GELENK_INLINE void SlideAlongZ(LaneNumbers* record, int part,
                                        const Pack* rotation, Pack* origin) {
    const Pack way = Get(record, kAngle, part);
    for (int k = 0; k < 3; ++k) {
      Put(record, kAxis + k, part, rotation[3 * k + 2]);
      origin[k] += way * rotation[3 * k + 2];
    }
  }

  static GELENK_INLINE void TurnByQuaternion(const ChainStep& step,
                                             LaneNumbers* record, int part,
                                             Pack* rotation,
                                             const Pack* origin) {
    Pack q[4], motion[9], turned[9];
    for (int k = 0; k < 4; ++k) q[k] = Get(record, kQuaternion + k, part);
    MatrixFromQuaternion(q, motion);
    Multiply(rotation, motion, turned);
    for (int k = 0; k < 9; ++k) rotation[k] = turned[k];
    if (step.limits_rotation) {
      // The axes in which the limits are a box.
      Pack basis[9];
      for (int k = 0; k < 9; ++k) basis[k] = Get(record, kBasis + k, part);
      Multiply(rotation, basis, turned);
    }
    for (int k = 0; k < 9; ++k) Put(record, kAxes + k, part, turned[k]);
    for (int k = 0; k < 3; ++k) Put(record, kCenter + k, part, origin[k]);
  }

  // Where each segment starts in the world, and the tip and the error as each
  // segment sees them.
  double JoinSegments() {
    // A frame in columns of four rows, so many rows of all lanes at a time.
    double end[4];
    for (int row = 0; row < 4; row += kRows) {
      Rows c[4] = {};
      for (int k = 0; k < kRows && row + k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
          c[j][k] = settings_.base_rotation[3 * (row + k) + j];
        }
        c[3][k] = settings_.base_translation[row + k];
      }
      for (int lane = 0; lane < chain_.lane_count; ++lane) {
        for (int k = 0; k < kRows && row + k < 3; ++k) {
          for (int j = 0; j < 3; ++j) {
            base_rotation_[3 * (row + k) + j][lane] = c[j][k];
          }
          base_[row + k][lane] = c[3][k];
        }
        Rows next[3];
        for (int j = 0; j < 3; ++j) {
          next[j] = c[0] * segment_rotation_[j][lane] +
                    c[1] * segment_rotation_[3 + j][lane] +
                    c[2] * segment_rotation_[6 + j][lane];
        }
        c[3] += c[0] * segment_end_[0][lane] + c[1] * segment_end_[1][lane] +
                c[2] * segment_end_[2][lane];
        for (int j = 0; j < 3; ++j) c[j] = next[j];
      }
      const double* t = chain_.last_from_tip;
      c[3] += c[0] * t[0] + c[1] * t[1] + c[2] * t[2];
      for (int k = 0; k < kRows; ++k) end[row + k] = c[3][k];
    }
    double energy = 0;
    *work_.position_error2 = 0;
    for (int i = 0; i < 3; ++i) {
      tip_[i] = end[i];
      error_[i] = target_.world_translation[i] - end[i];
      *work_.position_error2 += target_.row_counts[i] * error_[i] * error_[i];
      error_[i] *= target_.row_scale[i];
      energy += 0.5 * error_[i] * error_[i];
    }
    return energy;
  }

  GELENK_INLINE void TipInSegments(int part, Pack* out) const {
    Pack way[3];
    for (int k = 0; k < 3; ++k) way[k] = tip_[k] - Get(base_, k, part);
    ToSegments(way, part, out);
  }

  // A world vector, one for all or one for each, in the frames of the segments.
  template <typename Number>
  GELENK_INLINE void ToSegments(const Number* v, int part, Pack* out) const {
    for (int k = 0; k < 3; ++k) {
      out[k] = Get(base_rotation_, k, part) * v[0] +
               Get(base_rotation_, 3 + k, part) * v[1] +
               Get(base_rotation_, 6 + k, part) * v[2];
    }
  }

  static GELENK_INLINE void Accumulate(const Pack* j, const Pack& weight,
                                       Pack* m) {
    const Pack x = weight * j[0], y = weight * j[1], z = weight * j[2];
    m[0] += x * j[0], m[1] += x * j[1], m[2] += x * j[2];
    m[3] += y * j[1], m[4] += y * j[2];
    m[5] += z * j[2];
  }

  static GELENK_INLINE void Note(const Pack& g, const Pack& weight,
                                 const Pack& compliance, Pack* pushed,
                                 Pack* largest) {
    const Pack size = Vector::Abs(g);
    const Pack zero = {};
    *largest = Vector::Max(*largest, weight > 0 ? size : zero);
    *pushed =
        Vector::Max(*pushed, (weight == 0) & (compliance > 0) ? size : zero);
  }

  GELENK_INLINE void LinearizeScalar(const ChainStep& step, LaneNumbers* record,
                                     int part, const Pack* tip, const Pack* e,
                                     Pack* m, Pack* pushed, Pack* largest) {
    Pack axis[3], j[3];
    for (int k = 0; k < 3; ++k) axis[k] = Get(record, kAxis + k, part);
    if (step.type == NodeType::kRevolute) {
      Pack arm[3];
      for (int k = 0; k < 3; ++k)
        arm[k] = tip[k] - Get(record, kOrigin + k, part);
      Cross(axis, arm, j);
    } else {
      for (int k = 0; k < 3; ++k) j[k] = axis[k];
    }
    const Pack g = Dot(j, e);
    const Pack q = Get(record, kAngle, part);
    const Pack lower = Get(record, kLower, part),
               upper = Get(record, kUpper, part);
    const Mask blocked =
        ((q <= lower) & (g < 0)) | ((q >= upper) & (g > 0)) | (lower == upper);
    const Pack compliance = Get(step.compliance, 0, part);
    const Pack zero = {};
    const Pack weight = blocked ? zero : compliance;
    Put(record, kChange, part, zero);
    Note(g, weight, compliance, pushed, largest);
    Accumulate(j, weight, m);
    Put(record, kWeight, part, weight);
    for (int k = 0; k < 3; ++k) Put(record, kAxis + k, part, j[k]);
  }

  GELENK_INLINE void LinearizeSpherical(const ChainStep& step,
                                        LaneNumbers* record, int part,
                                        const Pack* tip, const Pack* e, Pack* m,
                                        Pack* pushed, Pack* largest) {
    Pack arm[3], j[3][3], g[3], weight[3];
    for (int k = 0; k < 3; ++k)
      arm[k] = tip[k] - Get(record, kCenter + k, part);
    for (int c = 0; c < 3; ++c) {
      const Pack axis[3] = {Get(record, kAxes + c, part),
                            Get(record, kAxes + 3 + c, part),
                            Get(record, kAxes + 6 + c, part)};
      Cross(axis, arm, j[c]);
      g[c] = Dot(j[c], e);
      weight[c] = Get(step.compliance, c, part);
    }
    if (step.limits_rotation) BlockRotations(step, part, g, weight);
    for (int c = 0; c < 3; ++c) {
      Note(g[c], weight[c], Get(step.compliance, c, part), pushed, largest);
      Accumulate(j[c], weight[c], m);
      Put(record, kWeights + c, part, weight[c]);
      for (int k = 0; k < 3; ++k) Put(record, kAxes + 3 * k + c, part, j[c][k]);
    }
  }

  void BlockRotations(const ChainStep& step, int part, const Pack* g,
                      Pack* weight) const {
    for (int i = 0; i < kWidth; ++i) {
      if (!step.limited[part + i]) continue;
      const uint8_t touched = work_.touched[step.node[part + i]];
      if (touched == 0) continue;
      if ((touched & kConeIsPoint) || ((touched & kTouchesCone) && g[0][i] > 0))
        weight[0][i] = 0;
      if (touched & kConeIsPoint) weight[1][i] = 0;
      if (((touched & kTouchesTwistLower) && g[2][i] < 0) ||
          ((touched & kTouchesTwistUpper) && g[2][i] > 0))
        weight[2][i] = 0;
    }
  }

  // force = W (W N W + damping)^-1 error, W the rows' weights.
  GELENK_INLINE void SolveStep(double damping, const double* error,
                               double* force) const {
    const double* w = target_.row_scale;
    double m[6];
    int at = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j, ++at) m[at] = w[i] * w[j] * normal_[at];
    }
    SolveDamped(m, damping, error, force);
    for (int k = 0; k < 3; ++k) force[k] *= w[k];
  }

  // S^-1 J^T force for what is free. Returns the longest change; `excess`
  // receives by how much a coordinate would leave its limits at worst.
  double FindChanges(const double* force, double* excess) {
    Pack longest = {}, beyond = {};
    for (int part = 0; part < part_end_; part += kWidth) {
      Pack v[3];
      ToSegments(force, part, v);
      for (int s = 0; s < chain_.step_count; ++s) {
        LaneNumbers* record = RecordOf(chain_.steps[s]);
        if (chain_.steps[s].type == NodeType::kSpherical) {
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
        const Pack j[3] = {Get(record, kAxis, part),
                           Get(record, kAxis + 1, part),
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
  void StopAtLimits(double* left) {
    Pack sum[6] = {}, moved[3] = {};
    for (int part = 0; part < part_end_; part += kWidth) {
      Pack m[6] = {}, shift[3] = {};
      for (int s = 0; s < chain_.step_count; ++s) {
        if (chain_.steps[s].type == NodeType::kSpherical) continue;
        LaneNumbers* record = RecordOf(chain_.steps[s]);
        const Pack j[3] = {Get(record, kAxis, part),
                           Get(record, kAxis + 1, part),
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
      AddToWorld(m, part, sum);
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
          moved[i] += Get(base_rotation_, 3 * i + k, part) * shift[k];
        }
      }
    }
    for (int k = 0; k < 6; ++k) normal_[k] -= Vector::Sum(sum[k]);
    for (int k = 0; k < 3; ++k) {
      left[k] -= target_.row_scale[k] * Vector::Sum(moved[k]);
    }
  }

  // sum += B m B^T for the segments' B; upper triangles.
  GELENK_INLINE void AddToWorld(const Pack* m, int part, Pack* sum) const {
    Pack b[9], half[9];
    for (int k = 0; k < 9; ++k) b[k] = Get(base_rotation_, k, part);
    const Pack full[9] = {m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5]};
    Multiply(b, full, half);
    int at = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) sum[at++] += Dot(half + 3 * i, b + 3 * j);
    }
  }

  // Moves q by `scale` times the changes, inside the limits.
  void Move(double scale) {
    for (int s = 0; s < chain_.step_count; ++s) {
      const ChainStep& step = chain_.steps[s];
      LaneNumbers* record = RecordOf(step);
      for (int part = 0; part < part_end_; part += kWidth) {
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
        ClampRotations(step, record);
        TouchLimits(step, record);
      }
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

  const ChainLayout& chain_;
  const TaskTarget& target_;
  const Settings& settings_;
  const ChainWorkspace& work_;
  double* const q_;
  const int part_end_;
  // By segments.
  alignas(64) LaneNumbers segment_rotation_[9];  // its end in its own frame
  alignas(64) LaneNumbers segment_end_[3];
  alignas(64) LaneNumbers base_rotation_[9] = {};  // its own frame in the world
  alignas(64) LaneNumbers base_[3] = {};
  double tip_[3];
  double error_[3];   // weighted
  double normal_[6];  // J S^-1 J^T, upper triangle, unweighted
};

}  // namespace

Attempt RunChain(const ChainLayout& chain, const TaskTarget& target,
                 const Settings& settings, const ChainWorkspace& workspace,
                 double* positions) {
  return ChainSolver(chain, target, settings, workspace, positions).Run();
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
