#include "gelenk/ik/two_bone.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// A direction shorter than this, relative to the limb, is none.
constexpr double kNoDirection = 1e-9;
// Rounding of a reach.
constexpr double kRounding = 1e-12;

Vector3d Across(const Vector3d& axis) {
  int least = 0;
  axis.cwiseAbs().minCoeff(&least);
  return axis.cross(Vector3d::Unit(least)).normalized();
}

// The unit direction of `v` across unit `axis`, or none.
std::optional<Vector3d> DirectionAcross(const Vector3d& v, const Vector3d& axis,
                                        double scale) {
  const Vector3d across = v - axis * axis.dot(v);
  if (across.norm() <= kNoDirection * scale) return std::nullopt;
  return across.normalized();
}

// Turn from the frame (a, n) to the frame (b, m): unit, at right angles.
Eigen::Quaterniond TurnBetween(const Vector3d& a, const Vector3d& n,
                               const Vector3d& b, const Vector3d& m) {
  Eigen::Matrix3d from;
  Eigen::Matrix3d to;
  from << a, n, a.cross(n);
  to << b, m, b.cross(m);
  return Eigen::Quaterniond(to * from.transpose()).normalized();
}

class Solver {
 public:
  explicit Solver(const TwoBoneProblem& problem)
      : p_(problem),
        upper_((problem.world_mid - problem.world_root).norm()),
        lower_((problem.world_tip - problem.world_mid).norm()),
        length_(upper_ + lower_),
        upper_axis_((problem.world_mid - problem.world_root) / upper_),
        lower_axis_((problem.world_tip - problem.world_mid) / lower_) {}

  TwoBoneAnswer Run() {
    const Vector3d way = p_.world_target - p_.world_root;
    const double distance = way.norm();
    const double fold = std::abs(upper_ - lower_);
    answer_.min_reach_m = fold;
    answer_.max_reach_m = length_ * p_.max_stretch;
    const double slack = kRounding * length_;
    answer_.unreachable =
        distance > answer_.max_reach_m + slack || distance < fold - slack;
    const double soft = std::max(Soften(distance), fold);
    answer_.stretch =
        distance > soft ? std::min(distance / soft, p_.max_stretch) : 1;
    const Vector3d rest_way = p_.world_tip - p_.world_root;
    rest_axis_ = rest_way.norm() > kNoDirection * length_
                     ? Vector3d(rest_way.normalized())
                     : Across(upper_axis_);
    axis_ = distance > kNoDirection * length_ ? Vector3d(way / distance)
                                              : rest_axis_;
    FindBends();
    Add(bend_, soft);
    // Straight and folded limbs are their own mirror images.
    if (soft < length_ && soft > fold) Add(-bend_, soft);
    answer_.distance_m =
        (answer_.solutions[0].world_tip - p_.world_target).norm();
    if (answer_.distance_m <= slack) answer_.distance_m = 0;
    return answer_;
  }

 private:
  double Soften(double distance) const {
    const double s = p_.soft_distance_m;
    const double begin = length_ - s;
    if (s == 0 || distance <= begin) return std::min(distance, length_);
    return begin + s * -std::expm1(-(distance - begin) / s);
  }

  // The bends at rest and now, both across their axes.
  void FindBends() {
    const Vector3d to_mid = p_.world_mid - p_.world_root;
    rest_bend_ = DirectionAcross(to_mid, rest_axis_, length_)
                     .value_or(Across(rest_axis_));
    bend_ = ShortestRotation(rest_axis_, axis_) * rest_bend_;
    if (p_.world_pole) {
      bend_ = DirectionAcross(*p_.world_pole - p_.world_root, axis_, length_)
                  .value_or(bend_);
    } else {
      bend_ = Eigen::AngleAxisd(p_.swivel_rad, axis_) * bend_;
    }
    // Exactly across, after the turns' rounding.
    bend_ = (bend_ - axis_ * axis_.dot(bend_)).normalized();
  }

  void Add(const Vector3d& bend, double r) {
    // The middle's place along and across the axis; heights by factors that do
    // not cancel near straight and folded.
    const double along =
        r > 0 ? 0.5 * (r + (upper_ - lower_) * length_ / r) : 0;
    const double fold = upper_ - lower_;
    const double area = (length_ - r) * (length_ + r) * (r - fold) * (r + fold);
    const double across =
        r > 0 ? 0.5 * std::sqrt(std::max(area, 0.0)) / r : upper_;
    const Vector3d mid = axis_ * along + bend * across;
    const Vector3d tip = axis_ * r;
    const Vector3d rest_normal = rest_axis_.cross(rest_bend_);
    const Vector3d normal = axis_.cross(bend);
    TwoBoneSolution& solution = answer_.solutions[answer_.solution_count++];
    solution.world_root_rotation =
        TurnBetween(upper_axis_, rest_normal, mid.normalized(), normal);
    solution.world_mid_rotation =
        TurnBetween(lower_axis_, rest_normal, (tip - mid).normalized(), normal);
    solution.world_mid = p_.world_root + answer_.stretch * mid;
    solution.world_tip = p_.world_root + answer_.stretch * tip;
  }

  const TwoBoneProblem& p_;
  const double upper_;
  const double lower_;
  const double length_;
  const Vector3d upper_axis_;
  const Vector3d lower_axis_;
  Vector3d rest_axis_;
  Vector3d rest_bend_;
  Vector3d axis_;
  Vector3d bend_;
  TwoBoneAnswer answer_;
};

}  // namespace

absl::Status CheckTwoBone(const TwoBoneProblem& problem) {
  Violations violations;
  CheckNumbers("world_root", problem.world_root, violations);
  CheckNumbers("world_mid", problem.world_mid, violations);
  CheckNumbers("world_tip", problem.world_tip, violations);
  CheckNumbers("world_target", problem.world_target, violations);
  if (problem.world_pole) {
    CheckNumbers("world_pole", *problem.world_pole, violations);
  }
  if (!violations.empty()) return violations.ToStatus();
  const double upper = (problem.world_mid - problem.world_root).norm();
  const double lower = (problem.world_tip - problem.world_mid).norm();
  if (!(upper > 0)) violations.Add("world_mid", "the upper bone has no length");
  if (!(lower > 0)) violations.Add("world_tip", "the lower bone has no length");
  CheckNumber("swivel_rad", problem.swivel_rad, violations);
  if (!(problem.soft_distance_m >= 0 &&
        problem.soft_distance_m < upper + lower)) {
    violations.Add(
        "soft_distance_m",
        absl::StrCat("want at least 0 and less than the limb's ", upper + lower,
                     ", got ", problem.soft_distance_m));
  }
  if (!(problem.max_stretch >= 1 && std::isfinite(problem.max_stretch))) {
    violations.Add(
        "max_stretch",
        absl::StrCat("want a finite number >= 1, got ", problem.max_stretch));
  }
  return violations.ToStatus();
}

TwoBoneAnswer SolveTwoBone(const TwoBoneProblem& problem) {
  return Solver(problem).Run();
}

}  // namespace gelenk
