#include "gelenk/skeleton/joint_order.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/testing/random.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Pairs of id and parent id.
using Tree = std::vector<std::pair<std::string, std::string>>;

struct Ordered {
  std::vector<int> order;
  std::vector<std::string> lines;
};

Ordered Order(const Tree& tree, int max_depth = 100) {
  std::vector<Joint> joints;
  for (const auto& [id, parent_id] : tree) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent_id;
    joints.push_back(joint);
  }
  Violations violations;
  Ordered ordered;
  ordered.order = OrderParentsFirst(joints, max_depth, violations);
  ordered.lines = ViolationLines(violations.ToStatus());
  return ordered;
}

TEST(JointOrderTest, KeepsAnOrderWithParentsFirst) {
  const Ordered ordered =
      Order({{"hip", ""}, {"left", "hip"}, {"right", "hip"}, {"toe", "left"}});
  EXPECT_THAT(ordered.order, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(ordered.lines, IsEmpty());
}

TEST(JointOrderTest, MovesJointsBehindTheirParents) {
  const Ordered ordered =
      Order({{"toe", "foot"}, {"hand", "hip"}, {"foot", "hip"}, {"hip", ""}});
  EXPECT_THAT(ordered.order, ElementsAre(3, 2, 0, 1));
  EXPECT_THAT(ordered.lines, IsEmpty());
}

TEST(JointOrderTest, ShuffledTreesComeOutParentsFirst) {
  Random random(1);
  for (int tree = 0; tree < 50; ++tree) {
    Tree joints = {{"j0", ""}};
    for (int i = 1; i < 30; ++i) {
      joints.push_back(
          {absl::StrCat("j", i), absl::StrCat("j", UniformIndex(random, i))});
    }
    std::shuffle(joints.begin(), joints.end(), random);
    const Ordered ordered = Order(joints);
    ASSERT_THAT(ordered.lines, IsEmpty());
    ASSERT_EQ(ordered.order.size(), joints.size());
    std::vector<std::string> placed = {""};
    for (int i : ordered.order) {
      EXPECT_THAT(placed, ::testing::Contains(joints[i].second));
      placed.push_back(joints[i].first);
    }
  }
}

TEST(JointOrderTest, ThereIsOneRoot) {
  EXPECT_THAT(Order({}).lines, ElementsAre("joints: want one root, got 0"));
  EXPECT_THAT(Order({{"a", ""}, {"b", ""}, {"c", "a"}}).lines,
              ElementsAre("joints: want one root, got 2"));
}

TEST(JointOrderTest, IdsAreUnique) {
  EXPECT_THAT(Order({{"a", ""}, {"b", "a"}, {"a", "b"}, {"b", "a"}}).lines,
              ElementsAre("joints[2].joint_id: duplicate \"a\"",
                          "joints[3].joint_id: duplicate \"b\""));
}

TEST(JointOrderTest, ParentsAreKnown) {
  EXPECT_THAT(Order({{"a", ""}, {"b", "A"}, {"c", "b"}}).lines,
              ElementsAre("joints[1].parent_joint_id: no joint \"A\""));
  const std::string long_id(1000000, 'x');
  EXPECT_THAT(Order({{"a", ""}, {"b", long_id}}).lines,
              ElementsAre("joints[1].parent_joint_id: no joint \"" +
                          long_id.substr(0, 63) + "...\""));
}

TEST(JointOrderTest, CyclesAreReportedOnce) {
  EXPECT_THAT(
      Order({{"root", ""}, {"a", "c"}, {"b", "a"}, {"c", "b"}, {"d", "c"}})
          .lines,
      ElementsAre(
          "joints[1].parent_joint_id: joint \"a\" is its own ancestor"));
}

TEST(JointOrderTest, NobodyIsTheirOwnParent) {
  EXPECT_THAT(Order({{"a", "a"}}).lines,
              ElementsAre("joints: want one root, got 0",
                          "joints[0].parent_joint_id: joint \"a\" is its own "
                          "ancestor"));
}

TEST(JointOrderTest, DepthIsBoundedFromBothSides) {
  const Tree chain = {{"c", "b"}, {"b", "a"}, {"a", ""}, {"d", "c"}};
  EXPECT_THAT(Order(chain, 4).lines, IsEmpty());
  EXPECT_THAT(Order(chain, 3).lines,
              ElementsAre("joints[3].parent_joint_id: deeper than 3 joints"));
}

TEST(JointOrderTest, LongChainsTakeNoStack) {
  Tree chain;
  constexpr int kJoints = 100000;
  for (int i = kJoints; i > 0; --i) {
    chain.push_back({std::to_string(i), std::to_string(i - 1)});
  }
  chain.push_back({"0", ""});
  const Ordered ordered = Order(chain, kJoints + 1);
  EXPECT_THAT(ordered.lines, IsEmpty());
  EXPECT_EQ(ordered.order.front(), kJoints);
}

}  // namespace
}  // namespace gelenk
