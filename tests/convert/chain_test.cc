#include "convert/chain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "convert/skeleton.h"
#include "convert/two_link.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

v1::Skeleton Chain() {
  v1::Skeleton skeleton;
  skeleton.mutable_planar_chain()->add_link_lengths(2);
  skeleton.mutable_planar_chain()->add_link_lengths(3);
  skeleton.mutable_planar_chain()->mutable_base()->set_x(1);
  return skeleton;
}

v1::DhTable Table() {
  v1::DhTable table;
  table.set_convention(v1::DhTable::CONVENTION_MODIFIED);
  v1::DhRow& row = *table.add_rows();
  row.set_a_m(0.1);
  row.set_alpha_rad(0.2);
  row.set_d_m(0.3);
  row.set_theta_rad(0.4);
  row.set_type(v1::JOINT_TYPE_PRISMATIC);
  row.mutable_limits()->add_lower(-1);
  row.mutable_limits()->add_upper(1);
  table.mutable_last_from_tool()->mutable_translation()->set_z(0.5);
  return table;
}

TEST(ConvertChainTest, APlanarChainBecomesASkeletonWithJoints) {
  const auto skeleton = FromProto(Chain()).value();
  EXPECT_EQ(skeleton->velocity_count(), 2);
  EXPECT_TRUE(skeleton->FindEffector("tip").has_value());
  v1::Skeleton movable = Chain();
  movable.mutable_planar_chain()->set_movable_base(true);
  EXPECT_EQ(FromProto(movable).value()->velocity_count(), 4);
}

// As a file of a chain is read, and then sent on.
TEST(ConvertChainTest, JointsTakeTheShorthandsPlace) {
  v1::Skeleton message = Chain();
  ToProto(*FromProto(message).value(), &message);
  EXPECT_EQ(message.shorthand_case(), v1::Skeleton::SHORTHAND_NOT_SET);
  EXPECT_EQ(message.dimension(), v1::DIMENSION_PLANAR);
  const auto again = FromProto(message);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ((*again)->velocity_count(), 2);
}

TEST(ConvertChainTest, ATableComesRound) {
  const DhTable table = FromProto(Table()).value();
  EXPECT_EQ(table.convention, DhConvention::kModified);
  EXPECT_EQ(table.rows[0].type, JointType::kPrismatic);
  v1::DhTable again;
  ToProto(table, &again);
  EXPECT_EQ(again.rows(0).DebugString(), Table().rows(0).DebugString());
  EXPECT_EQ(again.convention(), Table().convention());
  EXPECT_EQ(again.last_from_tool().translation().z(), 0.5);
}

TEST(ConvertChainTest, ATableBecomesASkeleton) {
  v1::Skeleton proto;
  *proto.mutable_dh_table() = Table();
  const auto skeleton = FromProto(proto).value();
  EXPECT_EQ(skeleton->joint(0).type, JointType::kPrismatic);
  EXPECT_EQ(skeleton->position_bounds().upper[0], 1);
}

TEST(ConvertChainTest, NamesEveryBadField) {
  v1::Skeleton both = Chain();
  both.add_joints();
  EXPECT_THAT(
      ViolationLines(FromProto(both).status()),
      ElementsAre("planar_chain: want joints or a shorthand, got both"));
  v1::Skeleton lifted = Chain();
  lifted.mutable_planar_chain()->mutable_base()->set_z(1);
  EXPECT_THAT(ViolationLines(FromProto(lifted).status()),
              ElementsAre("planar_chain.base.z: want 0, got 1"));
  v1::Skeleton table;
  *table.mutable_dh_table() = Table();
  table.mutable_dh_table()->clear_convention();
  table.mutable_dh_table()->mutable_rows(0)->clear_type();
  EXPECT_THAT(
      ViolationLines(FromProto(table).status()),
      ElementsAre("dh_table.convention: want standard or modified, got 0",
                  "dh_table.rows[0].type: no such joint type: 0"));
}

TEST(ConvertTwoLinkTest, PlanarThereAndBack) {
  v1::PlanarTwoLink proto;
  proto.set_upper_length_m(10);
  proto.set_lower_length_m(10);
  proto.mutable_target()->set_x(10);
  proto.add_current_angles_rad(1);
  proto.add_current_angles_rad(-2);
  proto.add_limits();
  proto.add_limits()->add_lower(-3);
  proto.mutable_limits(1)->add_upper(0);
  const TwoLinkProblem problem = FromProto(proto).value();
  v1::SolveTwoLinkResponse response;
  ToProto(SolveTwoLink(problem), &response);
  ASSERT_EQ(response.solutions_size(), 2);
  EXPECT_FALSE(response.solutions(0).within_limits());
  EXPECT_EQ(response.best(), 1);
  EXPECT_NEAR(response.solutions(1).world_tip().x(), 10, 1e-12);
  EXPECT_EQ(response.max_reach_m(), 20);
}

TEST(ConvertTwoLinkTest, NamesEveryBadPlanarField) {
  v1::PlanarTwoLink proto;
  proto.mutable_target()->set_z(1);
  proto.add_current_angles_rad(1);
  proto.add_limits();
  EXPECT_THAT(ViolationLines(FromProto(proto).status()),
              ElementsAre("target.z: want 0, got 1",
                          "current_angles_rad: want none or 2, got 1",
                          "limits: want none or 2, got 1",
                          HasSubstr("upper_length_m: "),
                          HasSubstr("lower_length_m: ")));
}

TEST(ConvertTwoLinkTest, TwoBones) {
  v1::TwoBoneLimb proto;
  proto.mutable_world_mid()->set_y(-1);
  proto.mutable_world_tip()->set_y(-2);
  proto.mutable_world_target()->set_x(1);
  proto.mutable_world_pole()->set_z(3);
  const TwoBoneProblem problem = FromProto(proto).value();
  EXPECT_EQ(problem.max_stretch, 1) << "0 reads as none";
  v1::SolveTwoLinkResponse response;
  ToProto(SolveTwoBone(problem), &response);
  ASSERT_EQ(response.solutions_size(), 2);
  EXPECT_GT(response.solutions(0).world_mid().z(), 0.5);
  EXPECT_NEAR(response.solutions(0).world_tip().x(), 1, 1e-12);
  proto.set_max_stretch(0.5);
  EXPECT_THAT(ViolationLines(FromProto(proto).status()),
              ElementsAre(HasSubstr("max_stretch: ")));
}

}  // namespace
}  // namespace gelenk::convert
