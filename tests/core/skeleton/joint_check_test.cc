#include "gelenk/skeleton/joint_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::StartsWith;

Joint JointOf(JointType type) {
  Joint joint;
  joint.id = "knee";
  joint.type = type;
  return joint;
}

std::vector<std::string> Lines(Joint joint) {
  Violations violations;
  CheckAndNormalize("joints[4]", joint, violations);
  return ViolationLines(violations.ToStatus());
}

TEST(CheckIdTest, TakesOneTo63Bytes) {
  for (const std::string& id : {std::string("k"), std::string(63, 'k'),
                                std::string("Knie links \xc3\xa4/#1")}) {
    Violations violations;
    CheckId("id", id, violations);
    EXPECT_TRUE(violations.empty()) << id;
  }
}

TEST(CheckIdTest, RefusesEmptyLongAndControlCharacters) {
  Violations violations;
  CheckId("a", "", violations);
  CheckId("b", std::string(64, 'k'), violations);
  CheckId("c", absl::string_view("kn\0o", 4), violations);
  CheckId("d", "kn\nee", violations);
  EXPECT_THAT(ViolationLines(violations.ToStatus()),
              ElementsAre("a: want 1 to 63 bytes, got 0",
                          "b: want 1 to 63 bytes, got 64",
                          "c: control character in \"kn\\x00o\"",
                          "d: control character in \"kn\\nee\""));
}

TEST(QuotedIdTest, EscapesAndCuts) {
  EXPECT_EQ(QuotedId("knee"), "\"knee\"");
  EXPECT_EQ(QuotedId("a\"b\x01"), "\"a\\\"b\\x01\"");
  EXPECT_EQ(QuotedId(std::string(1000000, 'k')),
            "\"" + std::string(63, 'k') + "...\"");
}

TEST(JointCheckTest, PlainJointsOfEveryTypeAreFine) {
  for (JointType type :
       {JointType::kFixed, JointType::kRevolute, JointType::kPrismatic,
        JointType::kSpherical, JointType::kPlanar, JointType::kFree}) {
    EXPECT_THAT(Lines(JointOf(type)), IsEmpty()) << JointTypeName(type);
  }
}

TEST(JointCheckTest, ListsEverythingAtOnce) {
  Joint joint = JointOf(JointType::kRevolute);
  joint.id = "";
  joint.axis = {0, 2, 0};
  joint.link_mass_kg = -1;
  EXPECT_THAT(
      Lines(joint),
      ElementsAre("joints[4].joint_id: want 1 to 63 bytes, got 0",
                  "joints[4].axis: want a unit vector, got (0, 2, 0)",
                  "joints[4].link_mass_kg: want a finite number >= 0, got -1"));
}

TEST(JointCheckTest, RestOffsetIsFiniteAndUnit) {
  Joint joint = JointOf(JointType::kFixed);
  joint.parent_from_joint.translation.y() = NAN;
  joint.parent_from_joint.rotation = Eigen::Quaterniond(0.5, 0, 0, 0.5);
  EXPECT_THAT(
      Lines(joint),
      ElementsAre("joints[4].parent_from_joint.translation: want finite "
                  "numbers, got (0, nan, 0)",
                  "joints[4].parent_from_joint.rotation: want a unit "
                  "quaternion, got (0, 0, 0.5, 0.5)"));
}

TEST(JointCheckTest, AxisCountsOnlyWhereItIsUsed) {
  for (JointType type :
       {JointType::kFixed, JointType::kSpherical, JointType::kFree}) {
    Joint joint = JointOf(type);
    joint.axis.setZero();
    EXPECT_THAT(Lines(joint), IsEmpty()) << JointTypeName(type);
  }
  Joint limited = JointOf(JointType::kSpherical);
  limited.axis.setZero();
  limited.limits.swing_cone_rad = 1;
  EXPECT_THAT(Lines(limited),
              ElementsAre("joints[4].axis: want a unit vector, got (0, 0, 0)"));
}

class NearUnitTest : public ::testing::TestWithParam<double> {};

TEST_P(NearUnitTest, IsNormalised) {
  Joint joint = JointOf(JointType::kRevolute);
  joint.axis = GetParam() * Eigen::Vector3d(0.48, 0.6, 0.64);
  joint.link_direction = GetParam() * Eigen::Vector3d(0.6, 0, 0.8);
  joint.parent_from_joint.rotation.coeffs() =
      GetParam() * Eigen::Vector4d(0.1, -0.5, 0.7, 0.5);
  Violations violations;
  CheckAndNormalize("joints[4]", joint, violations);
  EXPECT_TRUE(violations.empty());
  EXPECT_NEAR(joint.axis.norm(), 1, 1e-15);
  EXPECT_NEAR(joint.link_direction.norm(), 1, 1e-15);
  EXPECT_NEAR(joint.parent_from_joint.rotation.norm(), 1, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(BothSides, NearUnitTest,
                         ::testing::Values(1 - 0.999e-3, 1 - 1e-9, 1, 1 + 1e-9,
                                           1 + 0.999e-3));

TEST(JointCheckTest, DirectionsBeyondToleranceAreRefused) {
  for (double norm : {1 - 1.001e-3, 1 + 1.001e-3}) {
    Joint joint = JointOf(JointType::kRevolute);
    joint.axis *= norm;
    joint.link_direction *= norm;
    EXPECT_THAT(Lines(joint),
                ElementsAre(StartsWith("joints[4].axis: want a unit vector"),
                            StartsWith("joints[4].link_direction: want a")));
  }
}

TEST(JointCheckTest, LimitsFitTheType) {
  struct Case {
    JointType type;
    size_t count;
  };
  for (const Case& good :
       {Case{JointType::kRevolute, 1}, Case{JointType::kPrismatic, 1},
        Case{JointType::kPlanar, 3}, Case{JointType::kFree, 3},
        Case{JointType::kFixed, 0}, Case{JointType::kSpherical, 0}}) {
    Joint joint = JointOf(good.type);
    joint.limits.lower.assign(good.count, -1);
    joint.limits.upper.assign(good.count, 1);
    EXPECT_THAT(Lines(joint), IsEmpty()) << JointTypeName(good.type);
    joint.limits.lower.push_back(-1);
    joint.limits.upper.push_back(1);
    EXPECT_THAT(Lines(joint), ElementsAre("joints[4].limits.lower: want " +
                                          std::to_string(good.count) +
                                          " numbers or none, got " +
                                          std::to_string(good.count + 1)));
  }
}

TEST(JointCheckTest, LowerAndUpperHaveTheSameSize) {
  Joint joint = JointOf(JointType::kRevolute);
  joint.limits.upper = {1};
  EXPECT_THAT(Lines(joint),
              ElementsAre("joints[4].limits.upper: want as many numbers as "
                          "lower, 0, got 1"));
  joint.limits.lower = {-1};
  joint.limits.upper = {1, 2};
  EXPECT_THAT(Lines(joint),
              ElementsAre("joints[4].limits.upper: want as many numbers as "
                          "lower, 1, got 2"));
}

TEST(JointCheckTest, LowerIsNotAboveUpper) {
  Joint joint = JointOf(JointType::kPlanar);
  joint.limits.lower = {-1, 1.2, 0.5};
  joint.limits.upper = {1, 0.3, 0.5};
  EXPECT_THAT(Lines(joint),
              ElementsAre("joints[4].limits.lower[1]: joint \"knee\": lower "
                          "limit 1.2 > upper limit 0.3"));
}

TEST(JointCheckTest, InfinityMeansUnlimitedOnItsSideOnly) {
  Joint joint = JointOf(JointType::kRevolute);
  joint.limits.lower = {-INFINITY};
  joint.limits.upper = {INFINITY};
  EXPECT_THAT(Lines(joint), IsEmpty());
  joint.limits.lower = {INFINITY};
  EXPECT_THAT(Lines(joint),
              ElementsAre(StartsWith("joints[4].limits.lower[0]: ")));
  joint.limits.lower = {-INFINITY};
  joint.limits.upper = {-INFINITY};
  EXPECT_THAT(Lines(joint),
              ElementsAre(StartsWith("joints[4].limits.lower[0]: ")));
}

TEST(JointCheckTest, NanIsNoLimit) {
  Joint joint = JointOf(JointType::kRevolute);
  joint.limits.lower = {NAN};
  joint.limits.upper = {1};
  EXPECT_THAT(Lines(joint),
              ElementsAre("joints[4].limits.lower[0]: joint \"knee\": lower "
                          "limit nan > upper limit 1"));
}

TEST(JointCheckTest, SwingAndTwistAreForBallJoints) {
  for (JointType type : {JointType::kFixed, JointType::kRevolute,
                         JointType::kPrismatic, JointType::kPlanar}) {
    Joint joint = JointOf(type);
    joint.limits.swing_cone_rad = 1;
    EXPECT_THAT(Lines(joint),
                ElementsAre("joints[4].limits: swing and twist limits do not "
                            "fit a " +
                            std::string(JointTypeName(type)) + " joint"));
  }
}

TEST(JointCheckTest, SwingAndTwistHaveTheirRanges) {
  Joint joint = JointOf(JointType::kFree);
  joint.limits.swing_cone_rad = M_PI;
  joint.limits.twist_lower_rad = -2 * M_PI;
  joint.limits.twist_upper_rad = 2 * M_PI;
  EXPECT_THAT(Lines(joint), IsEmpty());
  joint.limits.swing_cone_rad = 3.15;
  joint.limits.twist_lower_rad = -6.3;
  joint.limits.twist_upper_rad = 6.3;
  EXPECT_THAT(
      Lines(joint),
      ElementsAre(
          "joints[4].limits.swing_cone_rad: want 0 to 3.14159 rad, got 3.15",
          "joints[4].limits.twist_lower_rad: want -6.28319 to 6.28319 rad, got "
          "-6.3",
          "joints[4].limits.twist_upper_rad: want -6.28319 to 6.28319 rad, got "
          "6.3"));
  joint.limits = {};
  joint.limits.swing_cone_rad = NAN;
  EXPECT_THAT(
      Lines(joint),
      ElementsAre(
          "joints[4].limits.swing_cone_rad: want 0 to 3.14159 rad, got nan"));
}

TEST(JointCheckTest, LowerTwistIsNotAboveUpperTwist) {
  Joint joint = JointOf(JointType::kSpherical);
  joint.limits.twist_lower_rad = 0.5;
  joint.limits.twist_upper_rad = 0.5;
  EXPECT_THAT(Lines(joint), IsEmpty());
  joint.limits.twist_upper_rad = 0.25;
  EXPECT_THAT(Lines(joint),
              ElementsAre("joints[4].limits.twist_lower_rad: joint \"knee\": "
                          "lower limit 0.5 > upper limit 0.25"));
}

TEST(JointCheckTest, ATwistSideThatIsNotGivenEndsAtHalfATurn) {
  Joint joint = JointOf(JointType::kSpherical);
  joint.limits.twist_lower_rad = 3;
  EXPECT_THAT(Lines(joint), IsEmpty());
  joint.limits.twist_lower_rad = 4;
  EXPECT_THAT(Lines(joint),
              ElementsAre("joints[4].limits.twist_lower_rad: joint \"knee\": "
                          "lower limit 4 > upper limit 3.14159"));
}

TEST(JointCheckTest, RatesAndStiffnessArePerDegreeOfFreedom) {
  Joint joint = JointOf(JointType::kSpherical);
  joint.limits.max_velocity = {1, 2, 3};
  joint.limits.max_acceleration = {0, 0, 0};
  joint.stiffness = {1, 1, 4};
  EXPECT_THAT(Lines(joint), IsEmpty());
  joint.limits.max_velocity = {1, 2, 3, 4};
  joint.limits.max_acceleration = {1, NAN, 3};
  joint.stiffness = {1, 1, -4};
  EXPECT_THAT(
      Lines(joint),
      ElementsAre("joints[4].limits.max_velocity: want 3 numbers or none, got "
                  "4",
                  "joints[4].limits.max_acceleration[1]: want a finite number "
                  ">= 0, got nan",
                  "joints[4].stiffness[2]: want a finite number >= 0, got -4"));
}

TEST(JointCheckTest, LinkHasLengthMassAndCentre) {
  Joint joint = JointOf(JointType::kFixed);
  joint.link_length_m = INFINITY;
  joint.link_mass_kg = NAN;
  joint.link_center_of_mass.z() = INFINITY;
  EXPECT_THAT(
      Lines(joint),
      ElementsAre("joints[4].link_length_m: want a finite number >= 0, got inf",
                  "joints[4].link_mass_kg: want a finite number >= 0, got nan",
                  "joints[4].link_center_of_mass: want finite numbers, got "
                  "(0, 0, inf)"));
}

TEST(JointCheckTest, OnlyScalarJointsFollow) {
  for (JointType type : {JointType::kFixed, JointType::kSpherical,
                         JointType::kPlanar, JointType::kFree}) {
    Joint joint = JointOf(type);
    joint.mimic = Mimic{"hip", 1, 0};
    EXPECT_THAT(Lines(joint), ElementsAre("joints[4].mimic: a " +
                                          std::string(JointTypeName(type)) +
                                          " joint cannot follow another"));
  }
}

TEST(JointCheckTest, MimicNumbersAreFinite) {
  Joint joint = JointOf(JointType::kRevolute);
  joint.mimic = Mimic{"hip", NAN, INFINITY};
  EXPECT_THAT(
      Lines(joint),
      ElementsAre("joints[4].mimic.multiplier: want a finite number, got nan",
                  "joints[4].mimic.offset: want a finite number, got inf"));
}

}  // namespace
}  // namespace gelenk
