#include "gelenk/ik/goals/pole_goal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::GoalOf;
using ::gelenk::testing::HingedLegAt;
using ::gelenk::testing::Leg;
using ::gelenk::testing::OriginOf;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Random;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;
using ::gelenk::testing::Uniform;

constexpr double kTolerance_m = 1e-4;
constexpr double kTolerance_rad = 1e-3;

PoleGoal PoleAt(const Eigen::Vector3d& point) {
  return {"hip", "knee", "ankle", point};
}

// From the bend to the pole about the line from hip to ankle, in [0, pi].
double MissedAngle(const Skeleton& leg, const Eigen::VectorXd& q,
                   const Eigen::Vector3d& pole) {
  const Eigen::Vector3d hip = OriginOf(leg, q, "hip");
  const Eigen::Vector3d axis = (OriginOf(leg, q, "ankle") - hip).normalized();
  const Eigen::Vector3d bend = (OriginOf(leg, q, "knee") - hip).cross(axis);
  const Eigen::Vector3d to = (pole - hip).cross(axis);
  return std::atan2(bend.cross(to).norm(), bend.dot(to));
}

TEST(PoleGoalTest, TheKneeGoesWhereItPoints) {
  Random random(1);
  for (const bool hinge : {false, true}) {
    const auto leg = Leg(hinge);
    const Eigen::VectorXd start =
        hinge ? HingedLegAt(0.4, 0.8)
              : SolveGoals(leg, {PositionGoalFor("ankle", {0, -0.6, 0.2})},
                           NeutralPositions(*leg))
                    .positions;
    for (int i = 0; i < 50; ++i) {
      const Eigen::Vector3d ankle(Uniform(random, -0.3, 0.3),
                                  Uniform(random, -0.75, -0.5),
                                  Uniform(random, -0.3, 0.3));
      const Eigen::Vector3d pole(std::sin(0.3 * i), -0.3, std::cos(0.3 * i));
      const Solved solved = SolveGoals(
          leg, {PositionGoalFor("ankle", ankle), GoalOf(PoleAt(pole))}, start);
      EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << i;
      EXPECT_LE((OriginOf(*leg, solved.positions, "ankle") - ankle).norm(),
                kTolerance_m);
      const double missed = MissedAngle(*leg, solved.positions, pole);
      EXPECT_LE(missed, 1.01 * kTolerance_rad) << i;
      EXPECT_NEAR(solved.report.rotation_errors_rad[1], missed, 1e-5);
    }
  }
}

// Behind the knee, with nothing to say which way round.
TEST(PoleGoalTest, ExactlyBehindTurnsRound) {
  const auto leg = Leg(true);
  const Eigen::VectorXd start = HingedLegAt(0.4, 0.8);
  const Eigen::Vector3d ankle = OriginOf(*leg, start, "ankle");
  const Eigen::Vector3d knee = OriginOf(*leg, start, "knee");
  const Eigen::Vector3d pole = 0.5 * ankle - 3 * (knee - 0.5 * ankle);
  ASSERT_NEAR(MissedAngle(*leg, start, pole), M_PI, 1e-9);
  const Solved solved = SolveGoals(
      leg, {PositionGoalFor("ankle", ankle), GoalOf(PoleAt(pole))}, start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(MissedAngle(*leg, solved.positions, pole), 1.01 * kTolerance_rad);
}

// A straight leg that must shorten: the gradient along it says nothing, the
// pole says which way the knee goes.
TEST(PoleGoalTest, AStraightLimbBendsTowardsThePole) {
  for (const bool hinge : {false, true}) {
    const auto leg = Leg(hinge);
    const Eigen::VectorXd straight = NeutralPositions(*leg);
    const Eigen::Vector3d pole(0, -0.4, 1);
    const Solved solved = SolveGoals(
        leg, {PositionGoalFor("ankle", {0, -0.6, 0}), GoalOf(PoleAt(pole))},
        straight);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
    EXPECT_LE(MissedAngle(*leg, solved.positions, pole), 1.01 * kTolerance_rad);
    EXPECT_GT(OriginOf(*leg, solved.positions, "knee").z(), 0.1);
  }
}

// Nothing to turn, nothing to nudge for: it stays straight and says so.
TEST(PoleGoalTest, AStraightLimbThatMustBeStraightStaysSo) {
  const auto leg = Leg(true);
  const Solved solved = SolveGoals(
      leg,
      {PositionGoalFor("ankle", {0, -0.85, 0}), GoalOf(PoleAt({0, -0.4, 1}))},
      HingedLegAt(0.1, 0.2));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_LE(solved.report.position_errors_m[0], kTolerance_m);
}

// Out of reach the leg is stretched, and the nudge costs next to nothing.
TEST(PoleGoalTest, BeyondReachTheDistanceIsRight) {
  const auto leg = Leg(true);
  const Solved solved = SolveGoals(
      leg,
      {PositionGoalFor("ankle", {0, -1.2, 0}), GoalOf(PoleAt({0, -0.4, 1}))},
      HingedLegAt(0.4, 0.8));
  EXPECT_NE(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_NEAR(solved.report.position_errors_m[0], 0.35, 1e-5);
}

// The pole on the axis, in the hip, in the ankle; the limb folded together.
TEST(PoleGoalTest, PolesThatSayNothingAskForNothing) {
  const auto leg = Leg(true);
  const Eigen::VectorXd bent = HingedLegAt(0.4, 0.8);
  const Eigen::Vector3d ankle = OriginOf(*leg, bent, "ankle");
  for (double along : {-2.0, 0.0, 1.0, 3.0}) {
    const Solved solved = SolveGoals(
        leg, {PositionGoalFor("ankle", ankle), GoalOf(PoleAt(along * ankle))},
        bent);
    EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged) << along;
    EXPECT_TRUE(solved.positions.allFinite());
  }
  const Solved straight =
      SolveGoals(leg, {GoalOf(PoleAt({0, -3, 0}))}, NeutralPositions(*leg));
  EXPECT_EQ(straight.report.outcome, SolveOutcome::kConverged);
  EXPECT_TRUE(straight.positions.isApprox(NeutralPositions(*leg)));
}

// A foot that moves smoothly through full stretch: no pop, no swap of sides.
TEST(PoleGoalTest, AStreamThroughFullStretchIsSmooth) {
  const auto leg = Leg(true);
  const Eigen::Vector3d pole(0, -0.4, 1);
  Eigen::VectorXd q = HingedLegAt(0.4, 0.8);
  Eigen::Vector3d knee = OriginOf(*leg, q, "knee");
  for (int frame = 0; frame < 240; ++frame) {
    // From 0.7 m down to 0.95 m, out of reach from 0.85 m on, and back.
    const double down = 0.825 - 0.125 * std::cos(2 * M_PI * frame / 120);
    const Solved solved = SolveGoals(
        leg, {PositionGoalFor("ankle", {0, -down, 0}), GoalOf(PoleAt(pole))},
        q);
    q = solved.positions;
    const Eigen::Vector3d now = OriginOf(*leg, q, "knee");
    EXPECT_NEAR(solved.report.position_errors_m[0], std::max(0.0, down - 0.85),
                2 * kTolerance_m)
        << frame;
    EXPECT_GT(now.z(), -1e-3);
    EXPECT_LT(std::abs(now.x()), 1e-3);
    // The bend goes as the root of what is missing to full stretch.
    EXPECT_LT((now - knee).norm(), frame > 0 ? 0.08 : 1) << frame;
    knee = now;
  }
}

}  // namespace
}  // namespace gelenk
