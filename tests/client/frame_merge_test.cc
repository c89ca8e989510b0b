#include "gelenk/client/frame_merge.h"

#include <gtest/gtest.h>

namespace gelenk::client {
namespace {

v1::GoalTarget* AddTarget(int goal_index, double x, v1::TargetFrame* frame) {
  v1::GoalTarget* target = frame->add_targets();
  target->set_goal_index(goal_index);
  target->mutable_world_position()->set_x(x);
  return target;
}

const v1::GoalTarget& TargetOf(int goal_index, const v1::TargetFrame& frame) {
  for (const v1::GoalTarget& target : frame.targets()) {
    if (target.goal_index() == goal_index) return target;
  }
  return v1::GoalTarget::default_instance();
}

TEST(FrameMergeTest, NewestTargetOfEachGoalWins) {
  v1::TargetFrame older;
  older.set_sequence_number(4);
  older.mutable_capture_time()->set_seconds(4);
  AddTarget(0, 10, &older);
  AddTarget(1, 11, &older);
  v1::TargetFrame newer;
  newer.set_sequence_number(5);
  newer.mutable_capture_time()->set_seconds(5);
  AddTarget(1, 21, &newer);
  AddTarget(2, 22, &newer);
  ASSERT_TRUE(Merge(newer, &older));
  EXPECT_EQ(older.sequence_number(), 5);
  EXPECT_EQ(older.capture_time().seconds(), 5);
  ASSERT_EQ(older.targets_size(), 3);
  EXPECT_EQ(TargetOf(0, older).world_position().x(), 10);
  EXPECT_EQ(TargetOf(1, older).world_position().x(), 21);
  EXPECT_EQ(TargetOf(2, older).world_position().x(), 22);
}

TEST(FrameMergeTest, WeightOutlivesATargetWithoutOne) {
  v1::TargetFrame older;
  AddTarget(0, 10, &older)->set_weight(3);
  AddTarget(1, 11, &older)->set_weight(4);
  v1::TargetFrame newer;
  AddTarget(0, 20, &newer);
  AddTarget(1, 21, &newer)->set_weight(5);
  ASSERT_TRUE(Merge(newer, &older));
  EXPECT_EQ(TargetOf(0, older).weight(), 3);
  EXPECT_EQ(TargetOf(1, older).weight(), 5);
}

TEST(FrameMergeTest, WeightAloneKeepsTheTarget) {
  v1::TargetFrame older;
  AddTarget(0, 10, &older);
  v1::TargetFrame newer;
  v1::GoalTarget* weight = newer.add_targets();
  weight->set_weight(2);
  weight = newer.add_targets();
  weight->set_goal_index(1);
  weight->set_weight(3);
  ASSERT_TRUE(Merge(newer, &older));
  EXPECT_EQ(TargetOf(0, older).world_position().x(), 10);
  EXPECT_EQ(TargetOf(0, older).weight(), 2);
  EXPECT_EQ(TargetOf(1, older).weight(), 3);
  EXPECT_EQ(TargetOf(1, older).target_case(), v1::GoalTarget::TARGET_NOT_SET);
}

TEST(FrameMergeTest, PlaceStaysUnlessMovedAgain) {
  v1::TargetFrame older;
  older.mutable_world_from_skeleton()->mutable_translation()->set_x(1);
  v1::TargetFrame still;
  ASSERT_TRUE(Merge(still, &older));
  EXPECT_EQ(older.world_from_skeleton().translation().x(), 1);
  v1::TargetFrame moved;
  moved.mutable_world_from_skeleton()->mutable_translation()->set_x(2);
  ASSERT_TRUE(Merge(moved, &older));
  EXPECT_EQ(older.world_from_skeleton().translation().x(), 2);
}

TEST(FrameMergeTest, PatchStaysApart) {
  v1::TargetFrame older;
  older.set_sequence_number(4);
  v1::TargetFrame patch;
  patch.set_sequence_number(5);
  patch.mutable_goal_patch()->add_removed_goal_ids("left");
  EXPECT_FALSE(Merge(patch, &older));
  EXPECT_EQ(older.sequence_number(), 4);

  v1::TargetFrame newer;
  newer.set_sequence_number(6);
  AddTarget(0, 20, &newer);
  ASSERT_TRUE(Merge(newer, &patch));
  EXPECT_EQ(patch.goal_patch().removed_goal_ids(0), "left");
  EXPECT_EQ(patch.sequence_number(), 6);
  EXPECT_EQ(patch.targets_size(), 1);
}

TEST(FrameMergeTest, ASourcePoseStaysUntilTheNext) {
  v1::TargetFrame older;
  older.mutable_source_pose()->add_positions(1);
  v1::TargetFrame newer;
  ASSERT_TRUE(Merge(newer, &older));
  EXPECT_EQ(older.source_pose().positions(0), 1);
  newer.mutable_source_pose()->add_positions(2);
  ASSERT_TRUE(Merge(newer, &older));
  ASSERT_EQ(older.source_pose().positions_size(), 1);
  EXPECT_EQ(older.source_pose().positions(0), 2);
}

}  // namespace
}  // namespace gelenk::client
