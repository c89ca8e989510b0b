#include "convert/joint_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gelenk/retarget/humanoid.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ConvertJointMapTest : public ::testing::Test {
 protected:
  v1::JointMap Proposal() const {
    v1::JointMap proto;
    ToProto({map_, *body_}, {map_, *body_}, &proto);
    return proto;
  }

  const std::shared_ptr<const Skeleton> body_ = MakeHumanoid();
  const JointMap map_ = ProposeJointMap(*body_).value();
};

TEST_F(ConvertJointMapTest, AnswersEveryRoleThatIsPlayed) {
  const v1::JointMap proto = Proposal();
  ASSERT_EQ(proto.pairs_size(), kBodyRoleCount);
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const v1::JointPair& pair = proto.pairs(i);
    EXPECT_EQ(pair.role(), i + 1);
    EXPECT_EQ(pair.source_joint_id(), body_->joint(map_.roles[i].joint).id);
    EXPECT_EQ(pair.target_joint_id(), pair.source_joint_id());
    EXPECT_GT(pair.source_confidence(), 0.5);
    EXPECT_NE(pair.source_evidence(), v1::ROLE_EVIDENCE_UNSPECIFIED);
  }
}

TEST_F(ConvertJointMapTest, AnAnswerSentBackIsTheSameMap) {
  const v1::JointMap proto = Proposal();
  for (MapSide side : {MapSide::kSource, MapSide::kTarget}) {
    const auto overrides = FromProto(proto, side, *body_);
    ASSERT_TRUE(overrides.ok()) << overrides.status();
    const auto again = ProposeJointMap(*body_, *overrides);
    ASSERT_TRUE(again.ok()) << again.status();
    for (int i = 0; i < kBodyRoleCount; ++i) {
      EXPECT_EQ(again->roles[i].joint, map_.roles[i].joint) << i;
      EXPECT_EQ(again->roles[i].evidence, RoleEvidence::kOverride) << i;
    }
  }
}

TEST_F(ConvertJointMapTest, UnsetLeavesTheChoiceAndEmptyIsNobody) {
  v1::JointMap proto;
  v1::JointPair* head = proto.add_pairs();
  head->set_role(v1::BODY_ROLE_HEAD);
  head->set_source_joint_id("");
  EXPECT_THAT(*FromProto(proto, MapSide::kTarget, *body_), IsEmpty());
  const auto overrides = FromProto(proto, MapSide::kSource, *body_);
  ASSERT_TRUE(overrides.ok()) << overrides.status();
  const auto map = ProposeJointMap(*body_, *overrides);
  ASSERT_TRUE(map.ok()) << map.status();
  EXPECT_FALSE(map->Has(BodyRole::kHead));
  EXPECT_TRUE(map->Has(BodyRole::kChest));
}

TEST_F(ConvertJointMapTest, NobodyOnOneSideIsLeftOut) {
  JointMap headless = map_;
  headless.roles[IndexOf(BodyRole::kHead)] = {};
  v1::JointMap proto;
  ToProto({headless, *body_}, {map_, *body_}, &proto);
  const v1::JointPair& head = proto.pairs(IndexOf(BodyRole::kHead));
  EXPECT_FALSE(head.has_source_joint_id());
  EXPECT_TRUE(head.has_target_joint_id());
}

TEST_F(ConvertJointMapTest, NamesEveryBadPair) {
  v1::JointMap proto;
  proto.add_pairs()->set_source_joint_id("pelvis");
  proto.add_pairs()->set_role(static_cast<v1::BodyRole>(21));
  v1::JointPair* pair = proto.add_pairs();
  pair->set_role(v1::BODY_ROLE_PELVIS);
  pair->set_source_joint_id("tail");
  pair = proto.add_pairs();
  pair->set_role(v1::BODY_ROLE_CHEST);
  pair->set_source_joint_id("pelvis");
  *proto.add_pairs() = *pair;
  proto.mutable_pairs(4)->set_role(v1::BODY_ROLE_NECK);
  *proto.add_pairs() = *pair;
  EXPECT_THAT(
      ViolationLines(FromProto(proto, MapSide::kSource, *body_).status()),
      ElementsAre("pairs[0].role: no such role: 0",
                  "pairs[1].role: no such role: 21",
                  HasSubstr("pairs[2].source_joint_id: no joint"),
                  HasSubstr("pairs[4].source_joint_id: two roles for"),
                  "pairs[5].role: chest comes twice"));
}

}  // namespace
}  // namespace gelenk::convert
