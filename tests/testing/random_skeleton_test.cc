#include "tests/testing/random_skeleton.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace gelenk::testing {
namespace {

// What a generator leaves out, no property test finds.
TEST(RandomSkeletonTest, EverythingOccurs) {
  Random random(2);
  std::map<JointType, int> types;
  int mimics = 0, branches = 0, frozen = 0, cones = 0, twists = 0;
  for (int tree = 0; tree < 200; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    ASSERT_EQ(skeleton->joint_count(), 12);
    EXPECT_FALSE(skeleton->end_effectors().empty());
    std::set<std::string> parents;
    for (const Joint& joint : skeleton->joints()) {
      ++types[joint.type];
      mimics += joint.mimic.has_value();
      branches += !parents.insert(joint.parent_id).second;
      cones += joint.limits.swing_cone_rad.has_value();
      twists += joint.limits.twist_lower_rad.has_value();
      for (size_t k = 0; k < joint.limits.lower.size(); ++k) {
        frozen += joint.limits.lower[k] == joint.limits.upper[k];
      }
    }
  }
  EXPECT_EQ(types.size(), 6u);
  for (const auto& [type, count] : types) EXPECT_GT(count, 200);
  for (int count : {mimics, branches, frozen, cones, twists}) {
    EXPECT_GT(count, 20);
  }
}

TEST(RandomSkeletonTest, SeedDecides) {
  Random first(3);
  Random second(3);
  Random other(4);
  const auto rest = [](Random& random) {
    return RandomSkeleton(random)->joint(0).parent_from_joint.translation;
  };
  const Eigen::Vector3d offset = rest(first);
  EXPECT_EQ(offset, rest(second));
  EXPECT_NE(offset, rest(other));
}

}  // namespace
}  // namespace gelenk::testing
