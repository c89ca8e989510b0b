#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/goal_argument.h"
#include "client/cli/tolerance.h"

namespace gelenk::cli {
namespace {

std::string MessageOf(const absl::Status& status) {
  return std::string(status.message());
}

TEST(GoalArgumentTest, ReadsAPoint) {
  const auto kind = ParsePositionGoal("LeftHand=0.4,1.2,-0.3");
  ASSERT_TRUE(kind.ok()) << kind.status();
  const auto& goal = std::get<PositionGoal>(*kind);
  EXPECT_EQ(goal.end_effector_id, "LeftHand");
  EXPECT_EQ(goal.world_position, Eigen::Vector3d(0.4, 1.2, -0.3));
}

TEST(GoalArgumentTest, IdsMayHoldEqualsColonsAndBlanks) {
  const auto kind = ParsePositionGoal("mixamorig:a=b c=1,2,3");
  ASSERT_TRUE(kind.ok()) << kind.status();
  EXPECT_EQ(EffectorId(*kind), "mixamorig:a=b c");
}

TEST(GoalArgumentTest, ReadsOrientationsWithWLast) {
  const auto kind = ParseRotationGoal("tool=0,0.6,0,0.8");
  ASSERT_TRUE(kind.ok()) << kind.status();
  const Eigen::Quaterniond& rotation =
      std::get<RotationGoal>(*kind).world_rotation;
  EXPECT_EQ(rotation.y(), 0.6);
  EXPECT_EQ(rotation.w(), 0.8);
}

TEST(GoalArgumentTest, ReadsPoses) {
  const auto kind = ParsePoseGoal("tool=1,2,3,0,0,1,0");
  ASSERT_TRUE(kind.ok()) << kind.status();
  const RigidTransform& pose = std::get<PoseGoal>(*kind).world_pose;
  EXPECT_EQ(pose.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose.rotation.z(), 1);
}

TEST(GoalArgumentTest, NamesTheFormItWants) {
  EXPECT_EQ(MessageOf(ParsePositionGoal("hand").status()),
            "want ID=x,y,z, got \"hand\"");
  EXPECT_EQ(MessageOf(ParsePositionGoal("=1,2,3").status()),
            "want ID=x,y,z, got \"=1,2,3\"");
  EXPECT_EQ(MessageOf(ParseRotationGoal("hand=1,2,3").status()),
            "want ID=qx,qy,qz,qw: want 4 numbers, got 3 in \"1,2,3\"");
  EXPECT_EQ(MessageOf(ParsePoseGoal("hand=a").status()),
            "want ID=x,y,z,qx,qy,qz,qw: want a number, got \"a\"");
}

TEST(GoalArgumentTest, GoalsOfOneEffectorGetNamesOfTheirOwn) {
  const std::vector<Goal> goals = NameGoals({*ParsePositionGoal("hand=0,0,0"),
                                             *ParseRotationGoal("hand=0,0,0,1"),
                                             *ParsePositionGoal("foot=0,0,0")});
  ASSERT_EQ(goals.size(), 3u);
  EXPECT_EQ(goals[0].id, "hand");
  EXPECT_NE(goals[1].id, "hand");
  EXPECT_EQ(goals[2].id, "foot");
}

TEST(ToleranceTest, OneNumberKeepsTheRotation) {
  const auto tolerance = ParseTolerance("2e-3", {1, 0.5});
  ASSERT_TRUE(tolerance.ok()) << tolerance.status();
  EXPECT_EQ(tolerance->position_m, 2e-3);
  EXPECT_EQ(tolerance->rotation_rad, 0.5);
  EXPECT_EQ(ParseTolerance("2e-3,0.1", {1, 0.5})->rotation_rad, 0.1);
}

TEST(ToleranceTest, RefusesWhatIsNoTolerance) {
  EXPECT_EQ(MessageOf(ParseTolerance("0", {}).status()),
            "want numbers above 0, got 0");
  EXPECT_EQ(MessageOf(ParseTolerance("1,2,3", {}).status()),
            "want metres, or metres and radians, got \"1,2,3\"");
}

}  // namespace
}  // namespace gelenk::cli
