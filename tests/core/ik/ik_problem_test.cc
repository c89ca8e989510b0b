#include "gelenk/ik/ik_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::RotationGoalFor;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> Lines(std::vector<Goal> goals) {
  return ViolationLines(
      IkProblem::Create(PandaArm(), std::move(goals)).status());
}

// One goal of each kind: 0 position, 1 rotation, 2 pose.
IkProblem EachKind() {
  return IkProblem::Create(
             PandaArm(), {PositionGoalFor("j3", {1, 2, 3}),
                          RotationGoalFor("j6", Eigen::Quaterniond::Identity()),
                          PoseGoalFor("tip", {})})
      .value();
}

TEST(IkProblemTest, KeepsItsGoals) {
  const IkProblem problem = EachKind();
  EXPECT_EQ(problem.skeleton().joint_count(), 7);
  ASSERT_EQ(problem.goals().size(), 3u);
  EXPECT_EQ(problem.goals()[2].id, "tip");
  EXPECT_TRUE(problem.world_from_skeleton().translation.isZero(0));
}

TEST(IkProblemTest, NoGoalsIsFine) {
  EXPECT_TRUE(IkProblem::Create(PandaArm(), {}).ok());
}

TEST(IkProblemTest, ListsEveryBadGoal) {
  Goal heavy = PositionGoalFor("j3", {0, 0, 0});
  heavy.weight = -2;
  Goal crooked = RotationGoalFor("j4", Eigen::Quaterniond(2, 0, 0, 0));
  Goal lost = PoseGoalFor("j4", {});
  std::get<PoseGoal>(lost.kind).end_effector_id = "tail\n";
  EXPECT_THAT(
      Lines({heavy, crooked, lost}),
      ElementsAre("goals[0].weight: want a finite number >= 0, got -2",
                  "goals[1].rotation.world_rotation: want a unit quaternion, "
                  "got (0, 0, 0, 2)",
                  "goals[2].goal_id: duplicate \"j4\"",
                  "goals[2].pose.end_effector_id: no end effector or joint "
                  "\"tail\\n\""));
}

std::vector<std::string> LinesOf(const GoalKind& kind) {
  return Lines({{"goal", 1, kind}});
}

TEST(IkProblemTest, EveryKindWantsItsEffector) {
  const auto line = [](absl::string_view kind) {
    return absl::StrCat("goals[0].", kind,
                        ".end_effector_id: no end effector or joint \"tail\"");
  };
  AimGoal aim;
  aim.end_effector_id = "tail";
  EXPECT_THAT(LinesOf(aim), ElementsAre(line("aim")));
  EXPECT_THAT(LinesOf(HalfSpaceGoal{"tail", {0, 1, 0}, 0}),
              ElementsAre(line("half_space")));
  EXPECT_THAT(LinesOf(PlantGoal{"tail", 1}), ElementsAre(line("plant")));
  EXPECT_THAT(LinesOf(RelativeGoal{"nose", "tail", {}, 1}),
              ElementsAre("goals[0].relative.reference_end_effector_id: no end "
                          "effector or joint \"nose\"",
                          line("relative")));
}

TEST(IkProblemTest, LimbsGoFromRootToTip) {
  EXPECT_THAT(LinesOf(PoleGoal{"hip", "tip", "j3", {0, 0, 1}}),
              ElementsAre("goals[0].pole.root_joint_id: no joint \"hip\"",
                          "goals[0].pole.mid_joint_id: no joint \"tip\""));
  EXPECT_THAT(LinesOf(PoleGoal{"j3", "j1", "j5", {0, 0, 1}}),
              ElementsAre("goals[0].pole.mid_joint_id: \"j1\" is not below "
                          "\"j3\""));
  EXPECT_THAT(LinesOf(PoleGoal{"j1", "j1", "j1", {0, 0, 1}}),
              ElementsAre("goals[0].pole.mid_joint_id: \"j1\" is not below "
                          "\"j1\"",
                          "goals[0].pole.tip_joint_id: \"j1\" is not below "
                          "\"j1\""));
}

TEST(IkProblemTest, LimbsGoDownOneBranch) {
  const auto person = PersonWithFingers();
  const auto lines = [&](const PoleGoal& pole) {
    return ViolationLines(
        IkProblem::Create(person, {{"goal", 1, pole}}).status());
  };
  std::vector<std::string> ids;
  for (const Joint& joint : person->joints()) ids.push_back(joint.id);
  const int left = person->FindEffector("left_palm")->joint;
  const int right = person->FindEffector("right_palm")->joint;
  const int root = 0;
  EXPECT_THAT(
      lines({ids[root], ids[left], ids[right], {0, 0, 1}}),
      ElementsAre(absl::StrCat("goals[0].pole.tip_joint_id: \"", ids[right],
                               "\" is not below \"", ids[left], "\"")));
}

TEST(IkProblemTest, PosturesHaveTheSizeOfTheSkeleton) {
  EXPECT_THAT(LinesOf(PostureGoal{Eigen::VectorXd::Zero(6), {1, 1, 1}}),
              ElementsAre("goals[0].posture.positions: want 7 numbers, got 6",
                          "goals[0].posture.joint_weights: want 7 numbers or "
                          "none, got 3"));
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(7);
  positions[2] = NAN;
  EXPECT_THAT(LinesOf(PostureGoal{positions, {}}),
              ElementsAre("goals[0].posture.positions[2]: want a finite number,"
                          " got nan"));
}

TEST(IkProblemTest, LongIdsMakeShortMessages) {
  Goal goal = PositionGoalFor("tip", {0, 0, 0});
  std::get<PositionGoal>(goal.kind).end_effector_id = std::string(1000000, 'x');
  Goal same = goal;
  goal.id = same.id = std::string(1000000, 'y');
  const absl::Status status =
      IkProblem::Create(PandaArm(), {goal, same}).status();
  EXPECT_LT(status.message().size(), 1000u);
}

TEST(IkProblemTest, NumberOfGoalsFromBothSides) {
  std::vector<Goal> goals;
  for (int i = 0; i < kMaxGoals; ++i) {
    goals.push_back(PositionGoalFor("tip", {0, 0, 0}));
    goals.back().id = absl::StrCat("g", i);
  }
  EXPECT_THAT(Lines(goals), IsEmpty());
  goals.push_back(goals.front());
  EXPECT_THAT(Lines(goals), ElementsAre("goals: want at most 256, got 257"));
}

TEST(IkProblemTest, TargetsFitTheGoal) {
  const IkProblem problem = EachKind();
  GoalTarget point = Eigen::Vector3d(1, 2, 3);
  GoalTarget rotation = Eigen::Quaterniond::Identity();
  GoalTarget pose = RigidTransform();
  EXPECT_TRUE(problem.CheckTarget(0, point).ok());
  EXPECT_TRUE(problem.CheckTarget(1, rotation).ok());
  EXPECT_TRUE(problem.CheckTarget(2, pose).ok());
  EXPECT_THAT(ViolationLines(problem.CheckTarget(0, pose)),
              ElementsAre("target: does not fit the position goal \"j3\""));
  EXPECT_THAT(ViolationLines(problem.CheckTarget(1, point)),
              ElementsAre("target: does not fit the rotation goal \"j6\""));
  EXPECT_THAT(ViolationLines(problem.CheckTarget(2, rotation)),
              ElementsAre("target: does not fit the pose goal \"tip\""));
}

TEST(IkProblemTest, TargetsNeedAGoal) {
  const IkProblem problem = EachKind();
  GoalTarget point = Eigen::Vector3d(1, 2, 3);
  EXPECT_THAT(ViolationLines(problem.CheckTarget(3, point)),
              ElementsAre("goal_index: want 0 to 2, got 3"));
  EXPECT_THAT(ViolationLines(problem.CheckTarget(-1, point)),
              ElementsAre("goal_index: want 0 to 2, got -1"));
}

TEST(IkProblemTest, MalformedTargetsAreRefused) {
  const IkProblem problem = EachKind();
  GoalTarget point = Eigen::Vector3d(1, 2, INFINITY);
  EXPECT_THAT(ViolationLines(problem.CheckTarget(0, point)),
              ElementsAre("world_position: want finite numbers, got (1, 2, "
                          "inf)"));
}

TEST(IkProblemTest, SetTargetReplacesIt) {
  IkProblem problem = EachKind();
  problem.SetTarget(0, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(std::get<PositionGoal>(problem.goals()[0].kind).world_position,
            Eigen::Vector3d(4, 5, 6));
}

TEST(IkProblemTest, WeightsFromBothSides) {
  EXPECT_TRUE(IkProblem::CheckWeight(0).ok());
  EXPECT_TRUE(IkProblem::CheckWeight(1e6).ok());
  for (double weight : {-1e-9, double{NAN}, double{INFINITY}}) {
    EXPECT_THAT(ViolationLines(IkProblem::CheckWeight(weight)),
                ElementsAre(absl::StrCat(
                    "weight: want a finite number >= 0, got ", weight)));
  }
  IkProblem problem = EachKind();
  problem.SetWeight(1, 0.5);
  EXPECT_EQ(problem.goals()[1].weight, 0.5);
}

TEST(IkProblemTest, MovesWithItsSkeleton) {
  IkProblem problem = EachKind();
  const IkProblem moved = std::move(problem);
  EXPECT_EQ(moved.skeleton().joint_count(), 7);
  EXPECT_GT(moved.ByteSize(), sizeof(IkProblem));
}

}  // namespace
}  // namespace gelenk
