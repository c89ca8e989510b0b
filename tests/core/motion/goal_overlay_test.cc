#include "gelenk/motion/goal_overlay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gelenk/retarget/humanoid.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::ViolationLines;

// A tolerance of the solver is 1e-4 m.
constexpr double kReached_m = 2e-4;

class GoalOverlayTest : public ::testing::Test {
 protected:
  // The left palm shall be 20 cm before and 30 cm below where the rest pose has
  // it.
  TimedGoal Reach(WeightCurve weight = 1) const {
    PositionGoal palm;
    palm.end_effector_id = "left_palm";
    palm.world_position = target_;
    return {.goal = {.id = "palm", .kind = palm}, .weight = std::move(weight)};
  }

  Eigen::Vector3d PalmAt(const Eigen::VectorXd& positions) const {
    WorldTransforms frames;
    ForwardKinematics(*body_, positions, frames);
    const EffectorFrame palm = *body_->FindEffector("left_palm");
    return (frames[palm.joint] * palm.joint_from_effector).translation;
  }

  Eigen::VectorXd Played(GoalOverlay& overlay, double time_s,
                         const Eigen::VectorXd& clip_pose) {
    Eigen::VectorXd positions = clip_pose;
    overlay.Apply(time_s, solver_, positions, report_);
    return positions;
  }
  Eigen::VectorXd Played(TimedGoal goal, double time_s) {
    GoalOverlay overlay =
        GoalOverlay::Create(body_, {std::move(goal)}, {}).value();
    return Played(overlay, time_s, body_->rest_positions());
  }

  const std::shared_ptr<const Skeleton> body_ = MakeHumanoid();
  const Eigen::Vector3d rest_palm_ = PalmAt(body_->rest_positions());
  const Eigen::Vector3d target_ = rest_palm_ + Eigen::Vector3d(-0.1, -0.3, 0.2);
  IkSolver solver_;
  SolveReport report_;
};

TEST_F(GoalOverlayTest, AtWeightOneTheGoalIsReached) {
  const Eigen::VectorXd positions = Played(Reach(), 0);
  EXPECT_LE((PalmAt(positions) - target_).norm(), kReached_m);
  EXPECT_EQ(report_.outcome, SolveOutcome::kConverged);
  EXPECT_EQ(report_.position_errors_m.size(), 1u) << "the posture is not told";
}

TEST_F(GoalOverlayTest, AtWeightZeroTheClipsHaveTheirWay) {
  EXPECT_EQ(Played(Reach(0), 0), body_->rest_positions());
}

TEST_F(GoalOverlayTest, InBetweenTheTargetIsOnTheWay) {
  const WeightCurve fade = WeightCurve::FadeIn(1, 2);
  for (double weight : {0.0, 0.25, 0.5, 1.0}) {
    const Eigen::VectorXd positions = Played(Reach(fade), 1 + 2 * weight);
    const Eigen::Vector3d wanted = rest_palm_ + weight * (target_ - rest_palm_);
    EXPECT_LE((PalmAt(positions) - wanted).norm(), kReached_m) << weight;
  }
}

TEST_F(GoalOverlayTest, TheRestOfTheBodyStaysAsTheClipsHaveIt) {
  const Eigen::VectorXd positions = Played(Reach(), 0);
  for (const char* id : {"right_hand", "left_foot", "right_foot", "head"}) {
    const JointSpan& span = body_->span(body_->FindJoint(id));
    const Eigen::VectorXd change =
        positions.segment(span.quaternion_offset, 4) -
        body_->rest_positions().segment(span.quaternion_offset, 4);
    EXPECT_LE(change.norm(), 1e-6) << id;
  }
}

TEST_F(GoalOverlayTest, TargetsMoveAlongTheirKeys) {
  TimedGoal goal = Reach();
  RigidTransform end;
  end.translation = rest_palm_;
  RigidTransform begin;
  begin.translation = target_;
  goal.targets = {{1, begin}, {3, end}};
  EXPECT_LE((PalmAt(Played(goal, 0)) - target_).norm(), kReached_m);
  EXPECT_LE((PalmAt(Played(goal, 2)) - 0.5 * (target_ + rest_palm_)).norm(),
            kReached_m);
  EXPECT_LE((PalmAt(Played(goal, 9)) - rest_palm_).norm(), kReached_m);
}

TEST_F(GoalOverlayTest, PosesDoNotDependOnTheOnesBefore) {
  GoalOverlay overlay = GoalOverlay::Create(body_, {Reach()}, {}).value();
  testing::Random random(3);
  const Eigen::VectorXd first = Played(overlay, 0, body_->rest_positions());
  Played(overlay, 1, testing::RandomPose(random, *body_));
  EXPECT_EQ(Played(overlay, 0, body_->rest_positions()), first);
}

TEST_F(GoalOverlayTest, TheActorStandsWhereItIsPut) {
  RigidTransform place;
  place.translation = {5, 0, 1};
  TimedGoal goal = Reach();
  std::get<PositionGoal>(goal.goal.kind).world_position += place.translation;
  GoalOverlay overlay = GoalOverlay::Create(body_, {goal}, {}, place).value();
  const Eigen::VectorXd positions = Played(overlay, 0, body_->rest_positions());
  EXPECT_LE((PalmAt(positions) - target_).norm(), kReached_m);
}

TEST_F(GoalOverlayTest, NamesEverythingThatIsWrong) {
  PostureGoal rest;
  rest.positions = body_->rest_positions();
  TimedGoal posture = {.goal = {.id = "posture", .kind = rest}};
  TimedGoal late = Reach(WeightCurve({{0, 2}}));
  late.goal.priority = kMaxPriorities - 1;
  TimedGoal backwards = Reach();
  backwards.goal.id = "other";
  backwards.targets = {{1, {}}, {1, {}}};
  AimGoal at_origin;
  at_origin.end_effector_id = "head";
  TimedGoal aim = {.goal = {.id = "aim", .kind = at_origin},
                   .targets = {{0, {}}}};
  EXPECT_THAT(
      ViolationLines(
          GoalOverlay::Create(body_, {posture, late, backwards, aim}, {})
              .status()),
      ElementsAre(HasSubstr("goals[0].goal: a posture"),
                  HasSubstr("goals[1].goal.priority: want at most 6"),
                  HasSubstr("goals[1].weight: want at most 1, got 2"),
                  HasSubstr("goals[2].targets[1].time_s"),
                  HasSubstr("goals[3].targets: want none of the kind aim")));
  TimedGoal nowhere = Reach();
  std::get<PositionGoal>(nowhere.goal.kind).end_effector_id = "tail";
  EXPECT_THAT(
      ViolationLines(GoalOverlay::Create(body_, {nowhere}, {}).status()),
      ElementsAre(HasSubstr("tail")));
}

}  // namespace
}  // namespace gelenk
