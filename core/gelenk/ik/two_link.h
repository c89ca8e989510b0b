// Two links in the plane, in closed form: both solutions, limits, and the
// nearest pose where there is none.
//
//   tip = base + l1 (cos p1, sin p1) + l2 (cos(p1 + p2), sin(p1 + p2))
//
// p2 comes from the half-angle form of the law of cosines,
//   p2 = 2 atan2(sqrt((l1 + l2)^2 - r^2), sqrt(r^2 - (l1 - l2)^2)),
// which is exact where the arc cosine loses half of its digits (stretched,
// folded); p1 from
//   p1 = atan2(y (l1 + l2 cos p2) - x l2 sin p2,
//              x (l1 + l2 cos p2) + y l2 sin p2).
// Angles are told in (-pi, pi], or whole turns off that to be within limits or
// near the current ones. Allocates nothing.
#ifndef GELENK_IK_TWO_LINK_H_
#define GELENK_IK_TWO_LINK_H_

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>

#include "absl/status/status.h"

namespace gelenk {

struct TwoLinkProblem {
  Eigen::Vector2d base = Eigen::Vector2d::Zero();
  // m, > 0.
  double upper_length_m = 1;
  double lower_length_m = 1;
  Eigen::Vector2d target = Eigen::Vector2d::Zero();
  // Picks among equals.
  std::optional<Eigen::Vector2d> current_rad;
  Eigen::Vector2d lower_rad =
      Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
  Eigen::Vector2d upper_rad =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
};

struct TwoLinkSolution {
  Eigen::Vector2d angles_rad = Eigen::Vector2d::Zero();
  Eigen::Vector2d mid = Eigen::Vector2d::Zero();
  Eigen::Vector2d tip = Eigen::Vector2d::Zero();
  bool within_limits = true;
  // Length of the change from current_rad; 0 without.
  double change_rad = 0;
};

struct TwoLinkAnswer {
  // Inside the reach both, p2 >= 0 first, or one where they are the same;
  // outside the nearest pose. When the limits allow none of these, the nearest
  // pose within the limits follows.
  std::array<TwoLinkSolution, 3> solutions;
  int solution_count = 0;
  // Of those within limits with the least distance, the one nearest to the
  // current angles (without: the first).
  int best = 0;
  // The target is outside the reach min_reach_m .. max_reach_m.
  bool unreachable = false;
  // From the best solution's tip to the target.
  double distance_m = 0;
  double min_reach_m = 0;
  double max_reach_m = 0;
};

// A target this near to the reach, relative to it, is in reach: rounding.
inline constexpr double kReachRounding = 1e-14;

// INVALID_ARGUMENT naming every bad field.
absl::Status CheckTwoLink(const TwoLinkProblem& problem);

// `problem` has passed CheckTwoLink.
TwoLinkAnswer SolveTwoLink(const TwoLinkProblem& problem);

}  // namespace gelenk

#endif  // GELENK_IK_TWO_LINK_H_
