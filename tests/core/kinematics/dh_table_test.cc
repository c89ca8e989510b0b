#include "gelenk/kinematics/dh_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/golden/dh_robots.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::PandaArm;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomTransform;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Positions of a few metres, and rotation matrices, to rounding.
constexpr double kTolerance = 1e-12;

double Gap(const RigidTransform& a, const RigidTransform& b) {
  return (a.translation - b.translation).norm() +
         (a.rotation.toRotationMatrix() - b.rotation.toRotationMatrix()).norm();
}

DhTable Table(DhConvention convention, const double (*rows)[4], int count) {
  DhTable table;
  table.convention = convention;
  for (int i = 0; i < count; ++i) {
    DhRow row;
    row.a_m = rows[i][0];
    row.alpha_rad = rows[i][1];
    row.d_m = rows[i][2];
    row.theta_rad = rows[i][3];
    table.rows.push_back(row);
  }
  return table;
}

// Against products of 4 x 4 matrices by a script; see make_dh_robots.py.
void ExpectGolden(const DhTable& table, const double* q, int count,
                  const double (&tip)[12]) {
  const auto skeleton = BuilderOf(table)->Build().value();
  const RigidTransform pose = EffectorPose(
      *skeleton, Eigen::Map<const Eigen::VectorXd>(q, count), "tip");
  const Eigen::Matrix3d m = pose.rotation.toRotationMatrix();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(m(r, c), tip[4 * r + c], kTolerance);
    }
    EXPECT_NEAR(pose.translation[r], tip[4 * r + 3], kTolerance);
  }
}

TEST(DhTableTest, PandaByModifiedRows) {
  DhTable table = Table(DhConvention::kModified, golden::kPandaRows, 7);
  table.last_from_tool.translation.z() = golden::kPandaFlange;
  ExpectGolden(table, golden::kPandaPose, 7, golden::kPandaTip);
}

TEST(DhTableTest, Ur5ByStandardRows) {
  ExpectGolden(Table(DhConvention::kStandard, golden::kUr5Rows, 6),
               golden::kUr5Pose, 6, golden::kUr5Tip);
}

// Joints whose axes are skew, parallel, intersecting or coincident with the one
// before; some prismatic, some fixed in between.
std::shared_ptr<const Skeleton> RandomChain(Random& random) {
  SkeletonBuilder builder;
  std::string parent;
  const int count = 1 + UniformIndex(random, 8);
  for (int i = 0; i < count; ++i) {
    Joint joint;
    joint.id = absl::StrCat("joint", i);
    joint.parent_id = parent;
    joint.type = UniformIndex(random, 4) == 0   ? JointType::kPrismatic
                 : UniformIndex(random, 6) == 0 ? JointType::kFixed
                                                : JointType::kRevolute;
    joint.axis = Eigen::Vector3d::UnitZ();
    switch (UniformIndex(random, 4)) {
      case 0:  // skew
        joint.parent_from_joint = RandomTransform(random, 1);
        joint.axis = RandomDirection(random);
        break;
      case 1:  // parallel
        joint.parent_from_joint.translation = RandomVector(random, 1);
        break;
      case 2:  // intersecting
        joint.parent_from_joint.translation.z() = Uniform(random, -1, 1);
        joint.axis = RandomDirection(random);
        break;
      default:  // coincident
        joint.parent_from_joint.translation.z() = Uniform(random, -1, 1);
        break;
    }
    builder.AddJoint(joint);
    parent = joint.id;
  }
  builder.AddEndEffector({"hand", parent, RandomTransform(random, 1)});
  return builder.Build().value();
}

class DhRoundTripTest : public ::testing::TestWithParam<DhConvention> {};

TEST_P(DhRoundTripTest, SameForwardKinematics) {
  Random random(1);
  int tables = 0;
  for (int round = 0; round < 300; ++round) {
    const auto skeleton = RandomChain(random);
    if (skeleton->velocity_count() == 0) continue;
    ++tables;
    const DhTable table = ToDhTable(*skeleton, "", "hand", GetParam()).value();
    EXPECT_EQ(static_cast<int>(table.rows.size()), skeleton->velocity_count());
    const auto again = BuilderOf(table)->Build().value();
    for (int k = 0; k < 3; ++k) {
      const Eigen::VectorXd q = RandomPose(random, *skeleton);
      // Nearly parallel axes put the perpendicular far away.
      double far = 1;
      for (const DhRow& row : table.rows) far += std::abs(row.d_m);
      EXPECT_LT(Gap(EffectorPose(*skeleton, q, "hand"),
                    EffectorPose(*again, q, "tip")),
                kTolerance * far)
          << "round " << round;
    }
    // And from there to the other convention and back.
    const DhConvention other = GetParam() == DhConvention::kStandard
                                   ? DhConvention::kModified
                                   : DhConvention::kStandard;
    const auto third =
        BuilderOf(ToDhTable(*again, "", "tip", other).value())->Build().value();
    const Eigen::VectorXd q = RandomPose(random, *skeleton);
    double far = 1;
    for (const DhRow& row : table.rows) far += std::abs(row.d_m);
    EXPECT_LT(
        Gap(EffectorPose(*skeleton, q, "hand"), EffectorPose(*third, q, "tip")),
        10 * kTolerance * far);
  }
  EXPECT_GT(tables, 250);
}

INSTANTIATE_TEST_SUITE_P(Both, DhRoundTripTest,
                         ::testing::Values(DhConvention::kStandard,
                                           DhConvention::kModified));

// Numbers that stand in a table come back, as far as it is unique.
TEST(DhTableTest, TheUr5ComesBackByItsNumbers) {
  const DhTable table = Table(DhConvention::kStandard, golden::kUr5Rows, 6);
  const auto skeleton = BuilderOf(table)->Build().value();
  const DhTable again =
      ToDhTable(*skeleton, "", "tip", DhConvention::kStandard).value();
  ASSERT_EQ(again.rows.size(), 6u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(std::abs(again.rows[i].a_m), std::abs(golden::kUr5Rows[i][0]),
                kTolerance);
    EXPECT_NEAR(std::abs(std::sin(again.rows[i].alpha_rad)),
                std::abs(std::sin(golden::kUr5Rows[i][1])), kTolerance);
  }
}

TEST(DhTableTest, PartsOfChains) {
  Random random(2);
  const auto arm = PandaArm();
  const DhTable table =
      ToDhTable(*arm, "j3", "tip", DhConvention::kModified).value();
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_EQ(table.rows[0].limits.lower, arm->joint(3).limits.lower);
  Eigen::VectorXd q = RandomPose(random, *arm);
  q.head(3).setZero();
  EXPECT_LT(Gap(EffectorPose(*arm, q, "tip"),
                EffectorPose(*BuilderOf(table)->Build().value(),
                             Eigen::VectorXd(q.tail(4)), "tip")),
            kTolerance);
}

TEST(DhTableTest, RefusesWhatATableCannotSay) {
  const auto lines = [](const Skeleton& skeleton, const std::string& base,
                        const std::string& tip) {
    return ViolationLines(
        ToDhTable(skeleton, base, tip, DhConvention::kStandard).status());
  };
  const auto arm = PandaArm();
  EXPECT_THAT(
      lines(*arm, "", "nose"),
      ElementsAre("end_effector_id: no end effector or joint \"nose\""));
  EXPECT_THAT(lines(*arm, "nose", "tip"),
              ElementsAre("base_joint_id: no joint \"nose\""));
  EXPECT_THAT(lines(*arm, "j4", "j2"),
              ElementsAre("base_joint_id: \"j4\" is not above the effector"));
  SkeletonBuilder builder;
  Joint ball;
  ball.id = "ball";
  ball.type = JointType::kSpherical;
  builder.AddJoint(ball);
  EXPECT_THAT(lines(*builder.Build().value(), "", "ball"),
              ElementsAre(HasSubstr("joint \"ball\" is spherical")));
}

TEST(DhTableTest, NamesEveryBadField) {
  DhTable table;
  table.rows.resize(2);
  table.rows[0].a_m = NAN;
  table.rows[1].theta_rad = INFINITY;
  table.rows[1].type = JointType::kFree;
  table.last_from_tool.translation.x() = NAN;
  EXPECT_THAT(
      ViolationLines(BuilderOf(table).status()),
      ElementsAre("rows[0].a_m: want a finite number, got nan",
                  "rows[1].theta_rad: want a finite number, got inf",
                  "rows[1].type: want revolute, prismatic or fixed, got free",
                  HasSubstr("last_from_tool")));
  EXPECT_THAT(ViolationLines(BuilderOf(DhTable()).status()),
              ElementsAre("rows: want at least one"));
}

}  // namespace
}  // namespace gelenk
