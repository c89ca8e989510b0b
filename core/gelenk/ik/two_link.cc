#include "gelenk/ik/two_link.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Eigen::Vector2d;

constexpr double kTurn = 2 * M_PI;
// Distances that differ by less, relative to the reach, are equal.
constexpr double kEqual = 1e-12;

Vector2d Direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

double Angle(const Vector2d& v) { return std::atan2(v.y(), v.x()); }

class Solver {
 public:
  explicit Solver(const TwoLinkProblem& problem)
      : p_(problem),
        delta_(problem.target - problem.base),
        reach_(problem.upper_length_m + problem.lower_length_m),
        fold_(std::abs(problem.upper_length_m - problem.lower_length_m)) {}

  TwoLinkAnswer Run() {
    answer_.min_reach_m = fold_;
    answer_.max_reach_m = reach_;
    const double distance = delta_.norm();
    const double slack = kReachRounding * reach_;
    answer_.unreachable = distance > reach_ + slack || distance < fold_ - slack;
    const double r = std::clamp(distance, fold_, reach_);
    const double bend = 2 * std::atan2(std::sqrt((reach_ - r) * (reach_ + r)),
                                       std::sqrt((r - fold_) * (r + fold_)));
    // Signs of p2 that differ.
    const bool twofold = bend > 0 && bend < M_PI;
    Add(At(bend));
    if (twofold) Add(At(-bend));
    if (!HasOneWithinLimits()) AddNearestWithinLimits();
    ChooseBest();
    return answer_;
  }

 private:
  // Both angles for a given second one.
  Vector2d At(double p2) const {
    const double l1 = p_.upper_length_m, l2 = p_.lower_length_m;
    const double x = delta_.x(), y = delta_.y();
    // The sine and cosine of half a turn are not exact: its pose is.
    const double c = std::abs(p2) == M_PI ? -1 : std::cos(p2);
    const double s = std::abs(p2) == M_PI ? 0 : std::sin(p2);
    const double across = y * (l1 + l2 * c) - x * l2 * s;
    const double along = x * (l1 + l2 * c) + y * l2 * s;
    // On the base every first angle is as good: stay.
    if (across == 0 && along == 0) return {Stay(), p2};
    return {std::atan2(across, along), p2};
  }

  double Stay() const {
    const double now = p_.current_rad ? p_.current_rad->x() : 0;
    return std::clamp(now, p_.lower_rad.x(), p_.upper_rad.x());
  }

  // The same direction whole turns away: within limits if there is one, then
  // nearest to the current angle (or to 0).
  double InLimits(double angle, int k) const {
    const double near = p_.current_rad ? (*p_.current_rad)[k] : 0;
    double turned = p_.current_rad
                        ? angle + kTurn * std::round((near - angle) / kTurn)
                        : angle;
    const double lower = p_.lower_rad[k], upper = p_.upper_rad[k];
    if (turned < lower) turned += kTurn * std::ceil((lower - turned) / kTurn);
    if (turned > upper) {
      const double back = turned - kTurn * std::ceil((turned - upper) / kTurn);
      // None fits: the nearest of them to the limits is no better.
      if (back >= lower) turned = back;
    }
    return turned;
  }

  void Add(const Vector2d& angles) {
    TwoLinkSolution& solution = answer_.solutions[answer_.solution_count++];
    solution.angles_rad = {InLimits(angles[0], 0), InLimits(angles[1], 1)};
    const Vector2d& a = solution.angles_rad;
    solution.mid = p_.base + p_.upper_length_m * Direction(a[0]);
    solution.tip = solution.mid + p_.lower_length_m * Direction(a[0] + a[1]);
    solution.within_limits = (a.array() >= p_.lower_rad.array()).all() &&
                             (a.array() <= p_.upper_rad.array()).all();
    if (p_.current_rad) solution.change_rad = (a - *p_.current_rad).norm();
  }

  bool HasOneWithinLimits() const {
    for (int i = 0; i < answer_.solution_count; ++i) {
      if (answer_.solutions[i].within_limits) return true;
    }
    return false;
  }

  double Distance(const Vector2d& a) const {
    return (p_.upper_length_m * Direction(a[0]) +
            p_.lower_length_m * Direction(a[0] + a[1]) - delta_)
        .norm();
  }

  // The distance is smooth in both angles, so that its least value within the
  // box of the limits is where it is stationary: inside, along an edge, or at a
  // corner. All of these are known in closed form.
  void AddNearestWithinLimits() {
    has_nearest_ = false;
    // Inside: stretched or folded in line with the target.
    for (double p2 : {0.0, M_PI, -M_PI}) Consider(At(p2));
    for (int side = 0; side < 2; ++side) {
      const Vector2d& bounds = side == 0 ? p_.lower_rad : p_.upper_rad;
      // Along the edge of the second angle the first turns a rigid pair of
      // links, along that of the first the second turns a single one.
      if (std::isfinite(bounds[1])) {
        Consider(At(bounds[1]));
        for (double p1 : {p_.lower_rad[0], p_.upper_rad[0]}) {
          if (std::isfinite(p1)) Consider({p1, bounds[1]});
        }
      }
      if (std::isfinite(bounds[0])) {
        const Vector2d rest = delta_ - p_.upper_length_m * Direction(bounds[0]);
        const double current = p_.current_rad ? (*p_.current_rad)[1] : 0;
        Consider({bounds[0],
                  rest.norm() > 0
                      ? Angle(rest) - bounds[0]
                      : std::clamp(current, p_.lower_rad[1], p_.upper_rad[1])});
      }
    }
    if (has_nearest_) Add(nearest_);
  }

  void Consider(const Vector2d& angles) {
    const Vector2d a = {InLimits(angles[0], 0), InLimits(angles[1], 1)};
    if ((a.array() < p_.lower_rad.array()).any() ||
        (a.array() > p_.upper_rad.array()).any()) {
      return;
    }
    const double distance = Distance(a);
    const double change = p_.current_rad ? (a - *p_.current_rad).norm() : 0;
    const double equal = kEqual * reach_;
    if (has_nearest_ &&
        (distance > nearest_distance_ + equal ||
         (distance > nearest_distance_ - equal && change >= nearest_change_))) {
      return;
    }
    has_nearest_ = true;
    nearest_ = a;
    nearest_distance_ = distance;
    nearest_change_ = change;
  }

  void ChooseBest() {
    answer_.best = -1;
    for (int i = 0; i < answer_.solution_count; ++i) {
      const TwoLinkSolution& solution = answer_.solutions[i];
      if (!solution.within_limits) continue;
      if (answer_.best < 0 ||
          solution.change_rad < answer_.solutions[answer_.best].change_rad) {
        answer_.best = i;
      }
    }
    const double distance =
        (answer_.solutions[answer_.best].tip - p_.target).norm();
    answer_.distance_m = distance <= kEqual * reach_ ? 0 : distance;
  }

  const TwoLinkProblem& p_;
  const Vector2d delta_;
  const double reach_;
  const double fold_;
  TwoLinkAnswer answer_;
  bool has_nearest_ = false;
  Vector2d nearest_ = Vector2d::Zero();
  double nearest_distance_ = 0;
  double nearest_change_ = 0;
};

}  // namespace

absl::Status CheckTwoLink(const TwoLinkProblem& problem) {
  Violations violations;
  CheckNumbers("base", problem.base, violations);
  CheckPositive("upper_length_m", problem.upper_length_m, violations);
  CheckPositive("lower_length_m", problem.lower_length_m, violations);
  CheckNumbers("target", problem.target, violations);
  if (problem.current_rad) {
    CheckNumbers("current_angles_rad", *problem.current_rad, violations);
  }
  for (int k = 0; k < 2; ++k) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (problem.lower_rad[k] <= problem.upper_rad[k] &&
        problem.lower_rad[k] < kInfinity && problem.upper_rad[k] > -kInfinity) {
      continue;
    }
    violations.Add(absl::StrCat("limits[", k, "]"),
                   absl::StrFormat("want lower <= upper, got %g > %g",
                                   problem.lower_rad[k], problem.upper_rad[k]));
  }
  return violations.ToStatus();
}

TwoLinkAnswer SolveTwoLink(const TwoLinkProblem& problem) {
  return Solver(problem).Run();
}

}  // namespace gelenk
