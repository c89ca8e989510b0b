#include "gelenk/ik/goals/plant_goal.h"

#include <gtest/gtest.h>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"
#include "tests/core/ik/goals/solve_goals.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/ik_targets.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GoalOf;
using ::gelenk::testing::OriginOf;
using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::Solved;
using ::gelenk::testing::SolveGoals;

constexpr double kTolerance_m = 1e-4;
constexpr double kTolerance_rad = 1e-3;

// A goal for the chest, 0, and a plant of the left sole, 1.
IkProblem ChestAndSole(double plant_weight) {
  Goal plant = GoalOf(PlantGoal{"left_sole", 1}, plant_weight);
  return IkProblem::Create(PersonWithFingers(),
                           {PositionGoalFor("chest", {0, 1.3, 0.1}), plant})
      .value();
}

double SoleMoved(const IkProblem& problem, const Eigen::VectorXd& before,
                 const Eigen::VectorXd& after) {
  const Skeleton& skeleton = problem.skeleton();
  return (EffectorPose(skeleton, before, "left_sole").translation -
          EffectorPose(skeleton, after, "left_sole").translation)
      .norm();
}

Eigen::VectorXd SolveFrom(const IkProblem& problem, Eigen::VectorXd q,
                          SolveReport* report = nullptr) {
  SolveReport ignored;
  LevenbergMarquardtSolver().Solve(problem, {}, SolveStart::kWarm, q,
                                   report ? *report : ignored);
  return q;
}

TEST(PlantGoalTest, HoldsWhereTheSolveStarts) {
  const auto person = PersonWithFingers();
  const Eigen::VectorXd start = person->rest_positions();
  const Solved solved = SolveGoals(person,
                                   {PositionGoalFor("chest", {0.1, 1.3, 0.2}),
                                    GoalOf(PlantGoal{"left_sole", 1})},
                                   start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  const RigidTransform before = EffectorPose(*person, start, "left_sole");
  const RigidTransform after =
      EffectorPose(*person, solved.positions, "left_sole");
  EXPECT_LE((before.translation - after.translation).norm(), kTolerance_m);
  EXPECT_LE(AngleBetween(before.rotation, after.rotation), kTolerance_rad);
}

TEST(PlantGoalTest, WithoutItTheSoleMoves) {
  const IkProblem problem = ChestAndSole(0);
  const Eigen::VectorXd start = problem.skeleton().rest_positions();
  EXPECT_GT(SoleMoved(problem, start, SolveFrom(problem, start)), 0.01);
}

TEST(PlantGoalTest, RotationScaleZeroHoldsThePointOnly) {
  const auto person = PersonWithFingers();
  const Eigen::VectorXd start = person->rest_positions();
  const Solved solved = SolveGoals(person,
                                   {PositionGoalFor("chest", {0.1, 1.3, 0.2}),
                                    GoalOf(PlantGoal{"left_sole", 0})},
                                   start);
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(solved.report.rotation_errors_rad[1], 0);
  EXPECT_GT(AngleBetween(
                EffectorPose(*person, start, "left_sole").rotation,
                EffectorPose(*person, solved.positions, "left_sole").rotation),
            0.01);
}

// Once captured it is the same place for good, however many frames follow.
TEST(PlantGoalTest, DoesNotDrift) {
  IkProblem problem = ChestAndSole(1);
  Eigen::VectorXd q = problem.skeleton().rest_positions();
  const Eigen::VectorXd start = q;
  EXPECT_TRUE(problem.has_free_plants());
  for (int frame = 0; frame < 100; ++frame) {
    problem.SetTarget(0, Eigen::Vector3d(0.1 * std::sin(0.1 * frame), 1.3,
                                         0.1 + 0.05 * std::cos(0.1 * frame)));
    problem.CapturePlants(q);
    EXPECT_FALSE(problem.has_free_plants());
    q = SolveFrom(problem, q);
    EXPECT_LE(SoleMoved(problem, start, q), kTolerance_m) << frame;
  }
}

TEST(PlantGoalTest, SwitchedOffLetsGoAndOnTakesUpTheNewPlace) {
  IkProblem problem = ChestAndSole(1);
  Eigen::VectorXd q = problem.skeleton().rest_positions();
  problem.CapturePlants(q);
  problem.SetWeight(1, 0);
  EXPECT_FALSE(problem.has_free_plants());
  problem.SetTarget(0, Eigen::Vector3d(0.5, 1.3, 0));
  const Eigen::VectorXd moved = SolveFrom(problem, q);
  ASSERT_GT(SoleMoved(problem, q, moved), 0.1);
  problem.SetWeight(1, 2);
  EXPECT_TRUE(problem.has_free_plants());
  problem.CapturePlants(moved);
  problem.SetTarget(0, Eigen::Vector3d(0.4, 1.25, 0));
  EXPECT_LE(SoleMoved(problem, moved, SolveFrom(problem, moved)), kTolerance_m);
}

// From one weight to another it was on all along.
TEST(PlantGoalTest, AnotherWeightKeepsThePlace) {
  IkProblem problem = ChestAndSole(1);
  problem.CapturePlants(problem.skeleton().rest_positions());
  problem.SetWeight(1, 5);
  EXPECT_FALSE(problem.has_free_plants());
}

TEST(PlantGoalTest, TheActorMayMoveUnderIt) {
  IkProblem problem = ChestAndSole(1);
  const Eigen::VectorXd start = problem.skeleton().rest_positions();
  problem.CapturePlants(start);
  RigidTransform moved;
  moved.translation = {0.05, 0, 0};
  problem.SetWorldFromSkeleton(moved);
  SolveReport report;
  const Eigen::VectorXd q = SolveFrom(problem, start, &report);
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
  const Eigen::Vector3d sole =
      moved * OriginOf(problem.skeleton(), q, "left_sole");
  EXPECT_LE((sole - OriginOf(problem.skeleton(), start, "left_sole")).norm(),
            kTolerance_m);
}

TEST(PlantGoalTest, SurvivesInTheProblemThatTakesOver) {
  IkProblem before = ChestAndSole(1);
  const Eigen::VectorXd start = before.skeleton().rest_positions();
  before.CapturePlants(start);
  IkProblem after = ChestAndSole(3);
  after.KeepPlants(before);
  EXPECT_FALSE(after.has_free_plants());
  Eigen::VectorXd elsewhere = start;
  elsewhere[0] += 0.01;
  EXPECT_LE(SoleMoved(after, start, SolveFrom(after, elsewhere)), kTolerance_m);
}

TEST(PlantGoalTest, WhatWasOffDoesNotSurvive) {
  IkProblem before = ChestAndSole(0);
  before.CapturePlants(before.skeleton().rest_positions());
  IkProblem after = ChestAndSole(3);
  after.KeepPlants(before);
  EXPECT_TRUE(after.has_free_plants());
}

TEST(PlantGoalTest, TakesNoTarget) {
  const IkProblem problem = ChestAndSole(1);
  for (GoalTarget target :
       {GoalTarget(RigidTransform()), GoalTarget(std::monostate())}) {
    EXPECT_FALSE(problem.CheckTarget(1, target).ok());
  }
}

}  // namespace
}  // namespace gelenk
