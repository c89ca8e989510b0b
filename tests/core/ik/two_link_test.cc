#include "gelenk/ik/two_link.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/testing/random.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::ViolationLines;
using ::gelenk::testing::WithProbability;
using ::testing::ElementsAre;

// Rounding of a handful of operations on lengths of about 10.
constexpr double kTolerance = 1e-12;

TwoLinkProblem Problem(double l1, double l2, double x, double y) {
  TwoLinkProblem problem;
  problem.upper_length_m = l1;
  problem.lower_length_m = l2;
  problem.target = {x, y};
  return problem;
}

Eigen::Vector2d Tip(const TwoLinkProblem& p, const Eigen::Vector2d& a) {
  return p.base + Eigen::Vector2d(p.upper_length_m * std::cos(a[0]) +
                                      p.lower_length_m * std::cos(a[0] + a[1]),
                                  p.upper_length_m * std::sin(a[0]) +
                                      p.lower_length_m * std::sin(a[0] + a[1]));
}

// The worked example: 60 and 120 degrees, in that order of signs.
TEST(TwoLinkTest, BothSolutionsInOrder) {
  const TwoLinkAnswer answer = SolveTwoLink(Problem(10, 10, 10, 0));
  ASSERT_EQ(answer.solution_count, 2);
  EXPECT_FALSE(answer.unreachable);
  EXPECT_EQ(answer.distance_m, 0);
  EXPECT_NEAR(answer.solutions[0].angles_rad[0], -M_PI / 3, kTolerance);
  EXPECT_NEAR(answer.solutions[0].angles_rad[1], 2 * M_PI / 3, kTolerance);
  EXPECT_NEAR(answer.solutions[1].angles_rad[0], M_PI / 3, kTolerance);
  EXPECT_NEAR(answer.solutions[1].angles_rad[1], -2 * M_PI / 3, kTolerance);
}

TEST(TwoLinkTest, EveryPoseIsAmongTheSolutions) {
  Random random(1);
  for (int round = 0; round < 2000; ++round) {
    TwoLinkProblem p =
        Problem(Uniform(random, 0.2, 2), Uniform(random, 0.2, 2), 0, 0);
    p.base = {Uniform(random, -3, 3), Uniform(random, -3, 3)};
    const Eigen::Vector2d pose = {Uniform(random, -3.1, 3.1),
                                  Uniform(random, -3.1, 3.1)};
    p.target = Tip(p, pose);
    p.current_rad = pose;
    const TwoLinkAnswer answer = SolveTwoLink(p);
    EXPECT_FALSE(answer.unreachable);
    for (int i = 0; i < answer.solution_count; ++i) {
      EXPECT_LT((Tip(p, answer.solutions[i].angles_rad) - p.target).norm(),
                kTolerance);
    }
    // Near stretched and folded an angle has the digits of a square root.
    EXPECT_LT(answer.solutions[answer.best].change_rad, 1e-6);
  }
}

TEST(TwoLinkTest, StretchedAndFoldedAreExact) {
  const TwoLinkAnswer stretched = SolveTwoLink(Problem(2, 1, 0, 3));
  ASSERT_EQ(stretched.solution_count, 1);
  EXPECT_FALSE(stretched.unreachable);
  EXPECT_EQ(stretched.solutions[0].angles_rad, Eigen::Vector2d(M_PI / 2, 0));
  const TwoLinkAnswer folded = SolveTwoLink(Problem(2, 1, 1, 0));
  ASSERT_EQ(folded.solution_count, 1);
  EXPECT_FALSE(folded.unreachable);
  EXPECT_EQ(folded.solutions[0].angles_rad, Eigen::Vector2d(0, M_PI));
}

TEST(TwoLinkTest, BothSidesOfTheReach) {
  for (double r : {0.999, 1.001, 2.999, 3.001}) {
    const TwoLinkAnswer answer =
        SolveTwoLink(Problem(2, 1, r * std::cos(1), r * std::sin(1)));
    EXPECT_EQ(answer.min_reach_m, 1);
    EXPECT_EQ(answer.max_reach_m, 3);
    const bool out = r < 1 || r > 3;
    EXPECT_EQ(answer.unreachable, out) << r;
    EXPECT_EQ(answer.solution_count, out ? 1 : 2);
    EXPECT_NEAR(answer.distance_m, out ? 0.001 : 0, kTolerance);
  }
  // A short upper link points away to come near.
  const TwoLinkAnswer away = SolveTwoLink(Problem(1, 2, 0.5, 0));
  EXPECT_NEAR(std::abs(away.solutions[0].angles_rad[0]), M_PI, kTolerance);
  EXPECT_NEAR(away.distance_m, 0.5, kTolerance);
}

TEST(TwoLinkTest, OnTheBaseEveryFirstAngleSolvesItSoStay) {
  TwoLinkProblem p = Problem(1.5, 1.5, 0, 0);
  EXPECT_EQ(SolveTwoLink(p).solutions[0].angles_rad, Eigen::Vector2d(0, M_PI));
  p.current_rad = Eigen::Vector2d(0.7, -2);
  const TwoLinkAnswer answer = SolveTwoLink(p);
  EXPECT_FALSE(answer.unreachable);
  EXPECT_EQ(answer.distance_m, 0);
  // Of pi and -pi the one nearer to the current angle.
  EXPECT_EQ(answer.solutions[answer.best].angles_rad,
            Eigen::Vector2d(0.7, -M_PI));
  p.upper_rad[0] = 0.2;
  EXPECT_EQ(SolveTwoLink(p).solutions[0].angles_rad[0], 0.2);
  // Unequal links cannot get there, and stay in direction, too.
  p = Problem(2, 1, 0, 0);
  p.current_rad = Eigen::Vector2d(0.7, 2);
  EXPECT_TRUE(SolveTwoLink(p).unreachable);
  EXPECT_NEAR(SolveTwoLink(p).distance_m, 1, kTolerance);
  EXPECT_EQ(SolveTwoLink(p).solutions[0].angles_rad[0], 0.7);
}

TEST(TwoLinkTest, SolutionsOutsideOfLimitsAreToldAndTurnsCount) {
  TwoLinkProblem p = Problem(10, 10, 10, 0);
  p.lower_rad[1] = 0;
  p.upper_rad[1] = M_PI;  // or -120 degrees would be 240
  TwoLinkAnswer answer = SolveTwoLink(p);
  EXPECT_TRUE(answer.solutions[0].within_limits);
  EXPECT_FALSE(answer.solutions[1].within_limits);
  EXPECT_EQ(answer.best, 0);
  // -60 degrees is 300.
  p.lower_rad[0] = 0;
  p.upper_rad[0] = 2 * M_PI;
  answer = SolveTwoLink(p);
  EXPECT_TRUE(answer.solutions[0].within_limits);
  EXPECT_NEAR(answer.solutions[0].angles_rad[0], 5 * M_PI / 3, kTolerance);
}

// Against a fine search over the box.
TEST(TwoLinkTest, TheNearestPoseWithinLimits) {
  Random random(2);
  int limited = 0;
  for (int round = 0; round < 200; ++round) {
    TwoLinkProblem p =
        Problem(Uniform(random, 0.3, 1.5), Uniform(random, 0.3, 1.5),
                Uniform(random, -3, 3), Uniform(random, -3, 3));
    for (int k = 0; k < 2; ++k) {
      p.lower_rad[k] = Uniform(random, -3, 2);
      p.upper_rad[k] = p.lower_rad[k] + Uniform(random, 0, 1.5);
    }
    const TwoLinkAnswer answer = SolveTwoLink(p);
    const TwoLinkSolution& best = answer.solutions[answer.best];
    EXPECT_TRUE(best.within_limits);
    EXPECT_NEAR((best.tip - p.target).norm(), answer.distance_m, kTolerance);
    if (answer.best == answer.solution_count - 1 && answer.distance_m > 0) {
      ++limited;
    }
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        const Eigen::Vector2d share(double(i) / kSteps, double(j) / kSteps);
        const Eigen::Vector2d a =
            p.lower_rad + share.cwiseProduct(p.upper_rad - p.lower_rad);
        ASSERT_GE((Tip(p, a) - p.target).norm(), answer.distance_m - 1e-12);
      }
    }
  }
  EXPECT_GT(limited, 50);
}

TEST(TwoLinkTest, NamesEveryBadField) {
  TwoLinkProblem p = Problem(0, -1, NAN, 0);
  p.lower_rad[1] = 1;
  p.upper_rad[1] = 0;
  EXPECT_THAT(ViolationLines(CheckTwoLink(p)),
              ElementsAre("upper_length_m: want a finite number > 0, got 0",
                          "lower_length_m: want a finite number > 0, got -1",
                          "target: want finite numbers, got (nan, 0)",
                          "limits[1]: want lower <= upper, got 1 > 0"));
  p = Problem(1, 1, 1, 1);
  EXPECT_TRUE(CheckTwoLink(p).ok());
  p.lower_rad[0] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(CheckTwoLink(p).ok());
}

}  // namespace
}  // namespace gelenk
