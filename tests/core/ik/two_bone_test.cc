#include "gelenk/ik/two_bone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/testing/random.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kTolerance = 1e-12;

// A leg: hip, knee slightly in front, ankle.
TwoBoneProblem Leg() {
  TwoBoneProblem leg;
  leg.world_root = {0, 1, 0};
  leg.world_mid = {0, 0.55, 0.05};
  leg.world_tip = {0, 0.1, 0};
  leg.world_target = {0.1, 0.4, 0.2};
  return leg;
}

double UpperLength(const TwoBoneProblem& p) {
  return (p.world_mid - p.world_root).norm();
}
double LowerLength(const TwoBoneProblem& p) {
  return (p.world_tip - p.world_mid).norm();
}

TEST(TwoBoneTest, RotationsCarryTheBonesToTheTarget) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    TwoBoneProblem p;
    p.world_root = RandomVector(random, 1);
    p.world_mid = p.world_root + RandomVector(random, 1);
    p.world_tip = p.world_mid + RandomVector(random, 1);
    const double fold = std::abs(UpperLength(p) - LowerLength(p));
    const double reach = UpperLength(p) + LowerLength(p);
    p.world_target =
        p.world_root + Uniform(random, fold, reach) * RandomDirection(random);
    p.world_pole = p.world_root + RandomVector(random, 2);
    const TwoBoneAnswer answer = SolveTwoBone(p);
    EXPECT_FALSE(answer.unreachable);
    EXPECT_EQ(answer.distance_m, 0);
    ASSERT_EQ(answer.solution_count, 2);
    for (const TwoBoneSolution& s : answer.solutions) {
      const Eigen::Vector3d mid =
          p.world_root + s.world_root_rotation * (p.world_mid - p.world_root);
      const Eigen::Vector3d tip =
          mid + s.world_mid_rotation * (p.world_tip - p.world_mid);
      EXPECT_LT((mid - s.world_mid).norm(), kTolerance);
      EXPECT_LT((tip - p.world_target).norm(), kTolerance);
      EXPECT_NEAR(s.world_root_rotation.norm(), 1, kTolerance);
    }
    // The knee is on the pole's side, the mirror image on the other.
    const Eigen::Vector3d axis = (p.world_target - p.world_root).normalized();
    const auto across = [&](const Eigen::Vector3d& point) {
      const Eigen::Vector3d v = point - p.world_root;
      return Eigen::Vector3d(v - axis * axis.dot(v));
    };
    const Eigen::Vector3d pole = across(*p.world_pole).normalized();
    const Eigen::Vector3d knee = across(answer.solutions[0].world_mid);
    EXPECT_NEAR(knee.dot(pole), knee.norm(), 1e-9);
    EXPECT_LT((knee + across(answer.solutions[1].world_mid)).norm(), 1e-12);
  }
}

TEST(TwoBoneTest, AtRestNothingTurns) {
  TwoBoneProblem leg = Leg();
  leg.world_target = leg.world_tip;
  const TwoBoneSolution s = SolveTwoBone(leg).solutions[0];
  EXPECT_NEAR(
      s.world_root_rotation.angularDistance(Eigen::Quaterniond::Identity()), 0,
      1e-7);
  EXPECT_LT((s.world_mid - leg.world_mid).norm(), kTolerance);
}

TEST(TwoBoneTest, SwivelTurnsTheKneeAboutTheAxis) {
  TwoBoneProblem leg = Leg();
  const Eigen::Vector3d before = SolveTwoBone(leg).solutions[0].world_mid;
  leg.swivel_rad = 0.7;
  const Eigen::Vector3d after = SolveTwoBone(leg).solutions[0].world_mid;
  const Eigen::Vector3d axis = (leg.world_target - leg.world_root).normalized();
  const Eigen::Vector3d turned =
      leg.world_root + Eigen::AngleAxisd(0.7, axis) * (before - leg.world_root);
  EXPECT_LT((after - turned).norm(), kTolerance);
  leg.swivel_rad = M_PI;
  const TwoBoneAnswer mirrored = SolveTwoBone(leg);
  EXPECT_LT((mirrored.solutions[1].world_mid - before).norm(), kTolerance);
}

TEST(TwoBoneTest, APoleOnTheAxisKeepsTheRestBend) {
  TwoBoneProblem leg = Leg();
  const Eigen::Vector3d rest = SolveTwoBone(leg).solutions[0].world_mid;
  for (double share : {-1.0, 0.0, 0.5, 2.0}) {
    leg.world_pole =
        leg.world_root + share * (leg.world_target - leg.world_root);
    EXPECT_LT((SolveTwoBone(leg).solutions[0].world_mid - rest).norm(),
              kTolerance);
  }
}

TEST(TwoBoneTest, StraightRestLimbsAndTargetsOnTheRootAreFinite) {
  TwoBoneProblem p;
  p.world_mid = {0, -1, 0};
  p.world_tip = {0, -2, 0};
  p.world_target = {0, 0, 0};
  const TwoBoneAnswer folded = SolveTwoBone(p);
  EXPECT_FALSE(folded.unreachable);
  EXPECT_TRUE(folded.solutions[0].world_root_rotation.coeffs().allFinite());
  EXPECT_LT(folded.distance_m, kTolerance);
  p.world_target = {1, 0, 0};
  EXPECT_EQ(SolveTwoBone(p).distance_m, 0);
  // Folded at rest, too.
  p.world_tip = {0, 0, 0};
  EXPECT_EQ(SolveTwoBone(p).distance_m, 0);
}

TEST(TwoBoneTest, BothSidesOfTheReach) {
  TwoBoneProblem leg = Leg();
  const double reach = UpperLength(leg) + LowerLength(leg);
  for (double r : {reach - 0.01, reach + 0.01}) {
    leg.world_target = leg.world_root - Eigen::Vector3d(0, r, 0);
    const TwoBoneAnswer answer = SolveTwoBone(leg);
    EXPECT_EQ(answer.unreachable, r > reach);
    EXPECT_EQ(answer.solution_count, r > reach ? 1 : 2);
    EXPECT_NEAR(answer.distance_m, r > reach ? 0.01 : 0, kTolerance);
  }
}

TEST(TwoBoneTest, StretchClosesTheGapAsFarAsAllowed) {
  TwoBoneProblem leg = Leg();
  const double reach = UpperLength(leg) + LowerLength(leg);
  leg.max_stretch = 1.2;
  leg.world_target = leg.world_root - Eigen::Vector3d(0, 1.1 * reach, 0);
  TwoBoneAnswer answer = SolveTwoBone(leg);
  EXPECT_NEAR(answer.stretch, 1.1, kTolerance);
  EXPECT_FALSE(answer.unreachable);
  EXPECT_EQ(answer.distance_m, 0);
  leg.world_target = leg.world_root - Eigen::Vector3d(0, 1.3 * reach, 0);
  answer = SolveTwoBone(leg);
  EXPECT_EQ(answer.stretch, 1.2);
  EXPECT_TRUE(answer.unreachable);
  EXPECT_NEAR(answer.distance_m, 0.1 * reach, kTolerance);
}

// The knee's speed, relative to the target's, stays bounded where without
// softness it grows without bound.
TEST(TwoBoneTest, SoftnessKeepsTheKneeFromPopping) {
  const auto fastest = [](double soft) {
    TwoBoneProblem leg = Leg();
    leg.soft_distance_m = soft;
    double most = 0;
    Eigen::Vector3d last = Eigen::Vector3d::Zero();
    constexpr double kStep = 1e-5;
    for (int i = 0; i < 20000; ++i) {
      leg.world_target =
          leg.world_root - Eigen::Vector3d(0, 0.75 + i * kStep, 0);
      const TwoBoneAnswer answer = SolveTwoBone(leg);
      const Eigen::Vector3d knee = answer.solutions[0].world_mid;
      if (i > 0) most = std::max(most, (knee - last).norm() / kStep);
      last = knee;
    }
    return most;
  };
  EXPECT_GT(fastest(0), 20);
  EXPECT_LT(fastest(0.05), 5);
}

TEST(TwoBoneTest, TheSoftGapIsTold) {
  TwoBoneProblem leg = Leg();
  const double reach = UpperLength(leg) + LowerLength(leg);
  leg.soft_distance_m = 0.1;
  leg.world_target = leg.world_root - Eigen::Vector3d(0, reach, 0);
  // exp(-1) of the soft distance is left at full length.
  EXPECT_NEAR(SolveTwoBone(leg).distance_m, 0.1 * std::exp(-1), kTolerance);
  leg.world_target = leg.world_root - Eigen::Vector3d(0, reach - 0.1, 0);
  EXPECT_EQ(SolveTwoBone(leg).distance_m, 0);
}

TEST(TwoBoneTest, NamesEveryBadField) {
  TwoBoneProblem leg = Leg();
  leg.world_mid = leg.world_root;
  leg.soft_distance_m = -1;
  leg.max_stretch = 0.5;
  leg.swivel_rad = NAN;
  EXPECT_THAT(ViolationLines(CheckTwoBone(leg)),
              ElementsAre("world_mid: the upper bone has no length",
                          "swivel_rad: want a finite number, got nan",
                          HasSubstr("soft_distance_m: want at least 0"),
                          "max_stretch: want a finite number >= 1, got 0.5"));
  leg = Leg();
  EXPECT_TRUE(CheckTwoBone(leg).ok());
  leg.world_pole = Eigen::Vector3d(0, INFINITY, 0);
  EXPECT_THAT(ViolationLines(CheckTwoBone(leg)),
              ElementsAre(HasSubstr("world_pole: want finite numbers")));
}

}  // namespace
}  // namespace gelenk
