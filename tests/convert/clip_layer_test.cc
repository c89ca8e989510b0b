#include "convert/clip_layer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "convert/played_goal.h"
#include "gelenk/retarget/humanoid.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ConvertClipLayerTest : public ::testing::Test {
 protected:
  const std::shared_ptr<const Skeleton> body_ = MakeHumanoid();
  const MotionClip clip_ = MotionClip::Create(body_, {}).value();
};

TEST_F(ConvertClipLayerTest, UnsetIsTheWholeClipAtItsSpeed) {
  const auto layer = FromProto(v1::ClipLayer(), clip_);
  ASSERT_TRUE(layer.ok()) << layer.status();
  EXPECT_EQ(layer->kind, ClipLayer::Kind::kNormal);
  EXPECT_EQ(layer->mode, PlaybackMode::kClamp);
  EXPECT_EQ(layer->speed, 1);
  EXPECT_EQ(layer->weight.At(5), 1);
  EXPECT_TRUE(layer->joint_weights.empty());
}

TEST_F(ConvertClipLayerTest, EveryFieldArrives) {
  v1::ClipLayer proto;
  proto.set_mode(v1::ClipLayer::MODE_ADDITIVE);
  proto.set_start_s(2);
  proto.set_speed(-0.5);
  proto.set_loop(true);
  for (double time_s : {1., 2.}) {
    v1::WeightKey* key = proto.mutable_weight()->add_keys();
    key->set_time_s(time_s);
    key->set_weight(time_s);
  }
  const auto layer = FromProto(proto, clip_);
  ASSERT_TRUE(layer.ok()) << layer.status();
  EXPECT_EQ(layer->kind, ClipLayer::Kind::kAdditive);
  EXPECT_EQ(layer->start_s, 2);
  EXPECT_EQ(layer->speed, -0.5);
  EXPECT_EQ(layer->mode, PlaybackMode::kLoop);
  EXPECT_EQ(layer->weight.At(1.5), 1.5);
}

TEST_F(ConvertClipLayerTest, TheLastEntryOfAMaskCounts) {
  v1::JointMask mask;
  v1::MaskEntry* arm = mask.add_entries();
  arm->set_joint_id("left_upper_arm");
  arm->set_include_below(true);
  v1::MaskEntry* hand = mask.add_entries();
  hand->set_joint_id("left_hand");
  hand->set_weight(0.5);
  const auto weights = FromProto(*body_, mask);
  ASSERT_TRUE(weights.ok()) << weights.status();
  const auto weight = [&](const char* id) {
    return (*weights)[body_->FindJoint(id)];
  };
  EXPECT_EQ(weight("left_upper_arm"), 1);
  EXPECT_EQ(weight("left_forearm"), 1);
  EXPECT_EQ(weight("left_hand"), 0.5);
  EXPECT_EQ(weight("right_hand"), 0);
}

TEST_F(ConvertClipLayerTest, NamesWhatIsWrong) {
  v1::ClipLayer proto;
  proto.set_mode(static_cast<v1::ClipLayer::Mode>(7));
  proto.mutable_mask()->add_entries()->set_joint_id("tail");
  EXPECT_THAT(ViolationLines(FromProto(proto, clip_).status()),
              ElementsAre("mode: no such mode: 7",
                          HasSubstr("mask.entries[0].joint_id: no joint")));
}

TEST(ConvertPlayedGoalTest, EveryFieldArrives) {
  google::protobuf::RepeatedPtrField<v1::PlayedGoal> protos;
  v1::PlayedGoal& proto = *protos.Add();
  proto.mutable_goal()->set_goal_id("hand");
  proto.mutable_goal()->mutable_position()->set_end_effector_id("palm");
  proto.mutable_weight()->add_keys()->set_weight(0.25);
  v1::TargetKey* key = proto.add_targets();
  key->set_time_s(3);
  key->mutable_world_pose()->mutable_translation()->set_x(4);
  const auto goals = FromProto(protos);
  ASSERT_TRUE(goals.ok()) << goals.status();
  const TimedGoal& goal = (*goals)[0];
  EXPECT_EQ(goal.goal.id, "hand");
  EXPECT_EQ(goal.weight.At(0), 0.25);
  ASSERT_EQ(goal.targets.size(), 1u);
  EXPECT_EQ(goal.targets[0].time_s, 3);
  EXPECT_EQ(goal.targets[0].world_pose.translation.x(), 4);
  protos.Add()->mutable_goal()->set_goal_id("wishless");
  EXPECT_THAT(ViolationLines(FromProto(protos).status()),
              ElementsAre(HasSubstr("goals[1].goal.kind")));
}

}  // namespace
}  // namespace gelenk::convert
