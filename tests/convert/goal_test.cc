#include "convert/goal.h"

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::Goal PositionMessage(const std::string& id) {
  v1::Goal proto;
  proto.set_goal_id(id);
  proto.set_weight(0.25);
  v1::PositionGoal* position = proto.mutable_position();
  position->set_end_effector_id("palm");
  position->mutable_world_position()->set_x(1);
  position->mutable_world_position()->set_y(2);
  position->mutable_world_position()->set_z(3);
  position->mutable_axes()->set_x(true);
  position->mutable_axes()->set_z(true);
  return proto;
}

v1::Goal RotationMessage(const std::string& id) {
  v1::Goal proto;
  proto.set_goal_id(id);
  proto.set_weight(0);
  v1::RotationGoal* rotation = proto.mutable_rotation();
  rotation->set_end_effector_id("crown");
  rotation->mutable_world_rotation()->set_x(0.6);
  rotation->mutable_world_rotation()->set_y(0);
  rotation->mutable_world_rotation()->set_z(0);
  rotation->mutable_world_rotation()->set_w(0.8);
  return proto;
}

v1::Goal PoseMessage(const std::string& id) {
  v1::Goal proto;
  proto.set_goal_id(id);
  proto.set_weight(3);
  v1::PoseGoal* pose = proto.mutable_pose();
  pose->set_end_effector_id("sole");
  pose->mutable_world_pose()->mutable_translation()->set_y(-1);
  pose->mutable_world_pose()->mutable_rotation()->set_w(1);
  pose->set_rotation_scale_m_per_rad(0.5);
  pose->mutable_axes()->set_y(true);
  return proto;
}

v1::Goal Parse(const std::string& text) {
  v1::Goal proto;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &proto));
  return proto;
}

// One of each of the kinds beyond position, rotation and pose.
std::vector<v1::Goal> OtherKinds() {
  std::vector<v1::Goal> goals;
  for (const char* kind : {
           "rotation { end_effector_id: 'a' world_rotation { w: 1 } axes { y: "
           "true } }",
           "pose { end_effector_id: 'a' world_pose { translation { x: 1 } "
           "rotation { w: 1 } } rotation_scale_m_per_rad: 1 rotation_axes { x: "
           "true } }",
           "aim { end_effector_id: 'a' axis { x: 1 } world_point { y: 2 } }",
           "pole { root_joint_id: 'r' mid_joint_id: 'm' tip_joint_id: 't' "
           "world_point { z: 3 } }",
           "relative { reference_end_effector_id: 'r' end_effector_id: 'a' "
           "reference_from_end_effector { translation { x: 1 } rotation { w: 1 "
           "} } rotation_scale_m_per_rad: 0.5 }",
           "center_of_mass { world_position { x: 1 } axes { x: true z: true } "
           "}",
           "posture { pose { positions: 0.5 positions: -2 } joint_weights: 1 "
           "joint_weights: 0 }",
           "half_space { end_effector_id: 'a' plane { normal { y: 1 } "
           "offset_m: -0.5 } }",
           "half_space { end_effector_id: 'a' }",
           "plant { end_effector_id: 'a' rotation_scale_m_per_rad: 0 }",
       }) {
    goals.push_back(
        Parse(std::string("goal_id: 'g' weight: 2 priority: 3 ") + kind));
  }
  return goals;
}

std::vector<std::string> Ids(const std::vector<Goal>& goals) {
  std::vector<std::string> ids;
  for (const Goal& goal : goals) ids.push_back(goal.id);
  return ids;
}

// --- Goals ---

TEST(ConvertGoalTest, EveryOtherKindComesRound) {
  for (const v1::Goal& proto : OtherKinds()) {
    const auto goal = FromProto(proto);
    ASSERT_TRUE(goal.ok()) << goal.status();
    EXPECT_EQ(goal->priority, 3);
    v1::Goal again;
    ToProto(*goal, &again);
    EXPECT_EQ(again.DebugString(), proto.DebugString());
  }
}

TEST(ConvertGoalTest, UnsetPartsOfOtherKindsMeanDefaults) {
  const auto aim = std::get<AimGoal>(FromProto(Parse("aim {}"))->kind);
  EXPECT_EQ(aim.axis, Eigen::Vector3d::UnitZ());
  const auto plant = std::get<PlantGoal>(FromProto(Parse("plant {}"))->kind);
  EXPECT_EQ(plant.rotation_scale_m_per_rad, 1);
  const auto ground =
      std::get<HalfSpaceGoal>(FromProto(Parse("half_space {}"))->kind);
  EXPECT_TRUE(ground.is_ground);
  const auto rotation =
      std::get<RotationGoal>(FromProto(Parse("rotation {}"))->kind);
  EXPECT_EQ(rotation.axes.count(), 3);
}

TEST(ConvertGoalTest, EveryTargetHasItsForm) {
  const auto read = [](const std::string& text) {
    v1::GoalTarget proto;
    EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, &proto));
    GoalTarget target;
    EXPECT_TRUE(FromProto(proto, &target).ok());
    return target;
  };
  EXPECT_EQ(std::get<RigidTransform>(
                read("reference_from_end_effector { translation { x: 2 } }"))
                .translation.x(),
            2);
  EXPECT_EQ(
      std::get<Eigen::VectorXd>(read("posture { positions: 1 positions: 2 }")),
      Eigen::Vector2d(1, 2));
  const Plane plane =
      std::get<Plane>(read("plane { normal { z: 1 } offset_m: 4 }"));
  EXPECT_EQ(plane.world_normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(plane.offset_m, 4);
}

TEST(ConvertGoalTest, EveryKindComesRound) {
  for (const v1::Goal& proto :
       {PositionMessage("a"), RotationMessage("b"), PoseMessage("c")}) {
    const auto goal = FromProto(proto);
    ASSERT_TRUE(goal.ok()) << goal.status();
    v1::Goal again;
    ToProto(*goal, &again);
    EXPECT_EQ(again.DebugString(), proto.DebugString());
  }
}

TEST(ConvertGoalTest, EveryFieldHasItsPlace) {
  const Goal position = FromProto(PositionMessage("a")).value();
  EXPECT_EQ(position.id, "a");
  EXPECT_EQ(position.weight, 0.25);
  const auto& point = std::get<PositionGoal>(position.kind);
  EXPECT_EQ(point.end_effector_id, "palm");
  EXPECT_EQ(point.world_position, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(point.axes.x && !point.axes.y && point.axes.z);

  const Goal rotation = FromProto(RotationMessage("b")).value();
  EXPECT_EQ(rotation.weight, 0) << "set to zero is not unset";
  EXPECT_EQ(std::get<RotationGoal>(rotation.kind).world_rotation.coeffs(),
            QuaternionXyzw(0.6, 0, 0, 0.8).coeffs());

  const Goal pose = FromProto(PoseMessage("c")).value();
  const auto& kind = std::get<PoseGoal>(pose.kind);
  EXPECT_EQ(kind.world_pose.translation, Eigen::Vector3d(0, -1, 0));
  EXPECT_EQ(kind.rotation_scale_m_per_rad, 0.5);
  EXPECT_TRUE(!kind.axes.x && kind.axes.y && !kind.axes.z);
}

TEST(ConvertGoalTest, UnsetMeansDefaults) {
  v1::Goal proto;
  proto.mutable_pose();
  const Goal pose = FromProto(proto).value();
  EXPECT_EQ(pose.weight, 1);
  const auto& kind = std::get<PoseGoal>(pose.kind);
  EXPECT_EQ(kind.rotation_scale_m_per_rad, 1);
  EXPECT_TRUE(kind.axes.x && kind.axes.y && kind.axes.z);
  EXPECT_EQ(kind.world_pose.rotation.w(), 1);
  proto.mutable_rotation();
  const Goal rotation = FromProto(proto).value();
  EXPECT_EQ(std::get<RotationGoal>(rotation.kind).world_rotation.w(), 1);
}

TEST(ConvertGoalTest, AMaskOfNoAxesIsNotUnset) {
  v1::Goal proto;
  proto.mutable_position()->mutable_axes();
  const Goal goal = FromProto(proto).value();
  const AxisMask axes = std::get<PositionGoal>(goal.kind).axes;
  EXPECT_FALSE(axes.x || axes.y || axes.z);
  v1::Goal again;
  ToProto(goal, &again);
  EXPECT_TRUE(again.position().has_axes());
}

TEST(ConvertGoalTest, ScaleOfZeroIsNotUnset) {
  v1::Goal proto;
  proto.mutable_pose()->set_rotation_scale_m_per_rad(0);
  const Goal goal = FromProto(proto).value();
  EXPECT_EQ(std::get<PoseGoal>(goal.kind).rotation_scale_m_per_rad, 0);
}

TEST(ConvertGoalTest, EveryGoalThatWishesNothingIsNamed) {
  v1::Session proto;
  proto.add_goals()->set_goal_id("first");
  *proto.add_goals() = PositionMessage("second");
  proto.add_goals()->set_goal_id("third\n");
  EXPECT_THAT(ViolationLines(FromProto(proto.goals(), nullptr).status()),
              ElementsAre("goals[0].kind: goal \"first\" wishes nothing",
                          HasSubstr("goals[2].goal_id: "),
                          "goals[2].kind: goal \"third\\n\" wishes nothing"));
}

TEST(ConvertGoalTest, AMissingKindHidesNothing) {
  v1::Session proto;
  *proto.add_goals() = PositionMessage("twice");
  proto.mutable_goals(0)->mutable_position()->mutable_world_position()->set_y(
      NAN);
  v1::Goal* wishless = proto.add_goals();
  wishless->set_goal_id("twice");
  wishless->set_weight(-1);
  wishless->set_priority(99);
  *proto.add_goals() = RotationMessage("other");
  proto.mutable_goals(2)->set_weight(-2);
  const auto skeleton = gelenk::testing::PandaArm();
  EXPECT_THAT(ViolationLines(FromProto(proto.goals(), skeleton.get()).status()),
              ElementsAre(HasSubstr("goals[0].position.world_position"),
                          HasSubstr("goals[0].position.end_effector_id: no "),
                          HasSubstr("goals[1].weight: "),
                          HasSubstr("goals[1].priority: "),
                          "goals[1].kind: goal \"twice\" wishes nothing",
                          "goals[1].goal_id: duplicate \"twice\"",
                          HasSubstr("goals[2].weight: "),
                          HasSubstr("goals[2].rotation.end_effector_id: no ")));
}

TEST(ConvertGoalTest, AMissingKindAmongTooManyIsNotAll) {
  v1::Session proto;
  for (int i = 0; i <= kMaxGoals; ++i) {
    *proto.add_goals() = PositionMessage(absl::StrCat("g", i));
  }
  proto.mutable_goals(1)->clear_kind();
  EXPECT_THAT(ViolationLines(FromProto(proto.goals(), nullptr).status()),
              ElementsAre("goals: want at most 256, got 257",
                          "goals[1].kind: goal \"g1\" wishes nothing"));
}

TEST(ConvertGoalTest, ListsComeRoundInOrder) {
  v1::Session proto;
  *proto.add_goals() = PoseMessage("c");
  *proto.add_goals() = PositionMessage("a");
  const auto goals = FromProto(proto.goals(), nullptr);
  ASSERT_TRUE(goals.ok());
  v1::Session again;
  *again.add_goals() = RotationMessage("replaced");
  ToProto(*goals, again.mutable_goals());
  EXPECT_EQ(again.DebugString(), proto.DebugString());
}

// --- Targets ---

TEST(ConvertGoalTest, TargetsOfEachSort) {
  v1::GoalTarget proto;
  GoalTarget target;
  EXPECT_THAT(ViolationLines(FromProto(proto, &target)),
              ElementsAre("target: is not set"));
  proto.mutable_world_position()->set_z(4);
  ASSERT_TRUE(FromProto(proto, &target).ok());
  EXPECT_EQ(std::get<Eigen::Vector3d>(target), Eigen::Vector3d(0, 0, 4));
  proto.mutable_world_rotation()->set_y(1);
  ASSERT_TRUE(FromProto(proto, &target).ok());
  EXPECT_EQ(std::get<Eigen::Quaterniond>(target).y(), 1);
  proto.mutable_world_pose()->mutable_translation()->set_x(2);
  ASSERT_TRUE(FromProto(proto, &target).ok());
  EXPECT_EQ(std::get<RigidTransform>(target).translation.x(), 2);
  EXPECT_EQ(std::get<RigidTransform>(target).rotation.w(), 1);
}

// --- Patches ---

class GoalPatchTest : public ::testing::Test {
 protected:
  GoalPatchTest() {
    goals_ = {FromProto(PositionMessage("a")).value(),
              FromProto(RotationMessage("b")).value(),
              FromProto(PoseMessage("c")).value()};
  }
  absl::StatusOr<std::vector<Goal>> Merged() const {
    return Merge(goals_, patch_);
  }

  std::vector<Goal> goals_;
  v1::GoalPatch patch_;
};

TEST_F(GoalPatchTest, OfNothingChangesNothing) {
  EXPECT_THAT(Ids(Merged().value()), ElementsAre("a", "b", "c"));
}

TEST_F(GoalPatchTest, NewGoalsComeLast) {
  *patch_.add_goals() = PositionMessage("e");
  *patch_.add_goals() = PositionMessage("d");
  EXPECT_THAT(Ids(Merged().value()), ElementsAre("a", "b", "c", "e", "d"));
}

TEST_F(GoalPatchTest, RemovedGoalsCloseTheGap) {
  patch_.add_removed_goal_ids("b");
  EXPECT_THAT(Ids(Merged().value()), ElementsAre("a", "c"));
}

TEST_F(GoalPatchTest, ChangedGoalsStayWhereTheyAre) {
  *patch_.add_goals() = PoseMessage("a");
  const auto merged = Merged().value();
  EXPECT_THAT(Ids(merged), ElementsAre("a", "b", "c"));
  EXPECT_TRUE(std::holds_alternative<PoseGoal>(merged[0].kind));
  EXPECT_EQ(merged[0].weight, 3);
}

TEST_F(GoalPatchTest, KeepsTheKindWhereOnlyTheWeightIsSet) {
  v1::Goal* goal = patch_.add_goals();
  goal->set_goal_id("a");
  goal->set_weight(9);
  const Goal changed = Merged().value()[0];
  EXPECT_EQ(changed.weight, 9);
  EXPECT_EQ(std::get<PositionGoal>(changed.kind).world_position.x(), 1);
}

TEST_F(GoalPatchTest, MovesAGoalToAnotherPriority) {
  v1::Goal* goal = patch_.add_goals();
  goal->set_goal_id("a");
  goal->set_priority(2);
  const Goal changed = Merged().value()[0];
  EXPECT_EQ(changed.priority, 2);
  EXPECT_EQ(changed.weight, goals_[0].weight);
  EXPECT_TRUE(std::holds_alternative<PositionGoal>(changed.kind));
}

TEST_F(GoalPatchTest, KeepsTheWeightWhereOnlyTheKindIsSet) {
  v1::Goal* goal = patch_.add_goals();
  *goal = RotationMessage("a");
  goal->clear_weight();
  const Goal changed = Merged().value()[0];
  EXPECT_EQ(changed.weight, 0.25);
  EXPECT_TRUE(std::holds_alternative<RotationGoal>(changed.kind));
}

TEST_F(GoalPatchTest, MayReplaceWhatItRemoves) {
  patch_.add_removed_goal_ids("a");
  *patch_.add_goals() = RotationMessage("a");
  const auto merged = Merged().value();
  EXPECT_THAT(Ids(merged), ElementsAre("b", "c", "a"));
}

TEST_F(GoalPatchTest, NamesEveryFault) {
  patch_.add_removed_goal_ids("b");
  patch_.add_removed_goal_ids("nobody");
  patch_.add_goals()->set_goal_id("new");
  EXPECT_THAT(ViolationLines(Merged().status()),
              ElementsAre("goal_patch.removed_goal_ids[1]: no goal \"nobody\"",
                          "goal_patch.goals[0].kind: goal \"new\" wishes "
                          "nothing"));
}

}  // namespace
}  // namespace gelenk::convert
