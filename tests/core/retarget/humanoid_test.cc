#include "gelenk/retarget/humanoid.h"

#include <gtest/gtest.h>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/skeleton/pose.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

constexpr double kExact = 1e-12;

double HeightOf(const Skeleton& skeleton, const char* effector) {
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, skeleton.rest_positions(), world_from_joints);
  const auto frame = skeleton.FindEffector(effector);
  return (world_from_joints[frame->joint] *
          frame->joint_from_effector.translation)
      .y();
}

TEST(HumanoidTest, StandsOnTheGroundAndIsAsTallAsAnAdult) {
  const auto skeleton = MakeHumanoid();
  for (const char* sole :
       {"left_heel", "left_toe_tip", "right_heel", "right_toe_tip"}) {
    EXPECT_NEAR(HeightOf(*skeleton, sole), 0, kExact) << sole;
  }
  EXPECT_NEAR(HeightOf(*skeleton, "crown"), 1.75, kExact);
  EXPECT_EQ(LimitExcess(*skeleton, skeleton->rest_positions(), nullptr), 0);
}

TEST(HumanoidTest, HasEveryRoleForSure) {
  const auto skeleton = MakeHumanoid();
  const auto map = ProposeJointMap(*skeleton);
  ASSERT_TRUE(map.ok());
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const auto role = static_cast<BodyRole>(i);
    ASSERT_TRUE(map->Has(role)) << BodyRoleName(role);
    const std::string& id = skeleton->joint(map->joint(role)).id;
    EXPECT_EQ(id, role == BodyRole::kChest ? "upper_chest"
                                           : std::string(BodyRoleName(role)));
  }
  EXPECT_GT(map->Confidence(), 0.9);
}

TEST(HumanoidTest, IsFoundByName) {
  const auto found = BundledSkeleton("humanoid");
  ASSERT_TRUE(found.ok());
  EXPECT_EQ((*found)->joint_count(), 22);
  EXPECT_THAT(BundledSkeleton("centaur").status(),
              testing::Fails(absl::StatusCode::kNotFound, "humanoid"));
}

}  // namespace
}  // namespace gelenk
