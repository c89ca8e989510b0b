#include "gelenk/import/urdf_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/import/urdf_reader.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/pose.h"
#include "tests/core/import/urdf_oracle.h"
#include "tests/testing/gripper_arm_urdf.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/matrix_kinematics_oracle.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::EffectorPose;
using ::gelenk::testing::GripperArmUrdf;
using ::gelenk::testing::MatrixOf;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::UrdfOracle;
using ::gelenk::testing::ViolationLines;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// Products of some ten rotations and translations of a metre.
constexpr double kRounding = 1e-13;

UrdfDocument Read(absl::string_view text) {
  absl::StatusOr<UrdfDocument> document = ReadUrdf(text);
  EXPECT_TRUE(document.ok()) << document.status();
  return document.ok() ? *std::move(document) : UrdfDocument();
}

UrdfImport Import(absl::string_view text) {
  absl::StatusOr<UrdfImport> import = ImportUrdf(Read(text));
  EXPECT_TRUE(import.ok()) << import.status();
  return *std::move(import);
}

std::vector<std::string> Lines(absl::string_view text,
                               const SkeletonBounds& bounds = {}) {
  return ViolationLines(ImportUrdf(Read(text), bounds).status());
}

std::string LinkText(absl::string_view name) {
  return absl::StrCat("<link name=\"", name, "\"/>\n");
}

// One line each, so that lines can be counted.
std::string JointText(absl::string_view name, absl::string_view parent,
                      absl::string_view child, absl::string_view more = "") {
  return absl::StrCat("<joint name=\"", name,
                      "\" type=\"continuous\"><parent link=\"", parent,
                      "\"/><child link=\"", child, "\"/>", more, "</joint>\n");
}

std::string Robot(absl::string_view parts) {
  return absl::StrCat("<robot name=\"r\">\n", parts, "</robot>\n");
}

std::vector<std::string> JointIds(const Skeleton& skeleton) {
  std::vector<std::string> ids;
  for (const Joint& joint : skeleton.joints()) ids.push_back(joint.id);
  return ids;
}

std::vector<std::string> EndEffectorIds(const Skeleton& skeleton) {
  std::vector<std::string> ids;
  for (const EndEffector& effector : skeleton.end_effectors()) {
    ids.push_back(effector.id);
  }
  return ids;
}

const Joint& JointOf(const UrdfImport& import, absl::string_view id) {
  return import.skeleton->joint(import.skeleton->FindJoint(id));
}

TEST(UrdfImportTest, LinksAreWhereTheFileSays) {
  const std::string text = GripperArmUrdf();
  const UrdfImport import = Import(text);
  const Skeleton& skeleton = *import.skeleton;
  UrdfOracle oracle(text);
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd pose = RandomPose(random, skeleton);
    std::map<std::string, double> numbers;
    for (int i = 0; i < skeleton.joint_count(); ++i) {
      const int at = skeleton.span(i).position_offset;
      if (at >= 0) numbers[skeleton.joint(i).id] = pose[at];
    }
    for (const std::string& link : oracle.Links()) {
      // The joint "wrist" moves another link.
      const std::string id = link == "wrist" ? "wrist.link" : link;
      EXPECT_LT((MatrixOf(EffectorPose(skeleton, pose, id)) -
                 oracle.RootFromLink(link, numbers))
                    .norm(),
                kRounding)
          << link;
    }
  }
}

TEST(UrdfImportTest, JointsKeepTheirNamesAndLinksAreEndEffectors) {
  const UrdfImport import = Import(GripperArmUrdf());
  EXPECT_THAT(JointIds(*import.skeleton),
              ElementsAre("base", "yaw", "lift", "shoulder", "elbow", "wrist",
                          "flange", "finger", "finger_right", "finger_left"));
  EXPECT_THAT(EndEffectorIds(*import.skeleton),
              ElementsAre("column", "carriage", "upper_arm", "wrist.link",
                          "forearm", "palm", "tip_1", "tip_2", "tip_3"));
  EXPECT_EQ(import.skeleton->joint_count(),
            ::gelenk::testing::kGripperArmJointCount);
  EXPECT_EQ(import.skeleton->position_count(),
            ::gelenk::testing::kGripperArmPositionCount);
  EXPECT_EQ(import.skeleton->up(), Eigen::Vector3d::UnitZ());
  EXPECT_EQ(import.skeleton->joint(0).type, JointType::kFixed);
  EXPECT_THAT(import.warnings, Contains(HasSubstr("\"wrist.link\"")));
}

TEST(UrdfImportTest, LimitsVelocitiesAndMassesComeAlong) {
  const UrdfImport import = Import(GripperArmUrdf());
  const Joint& elbow = JointOf(import, "elbow");
  EXPECT_THAT(elbow.limits.lower, ElementsAre(0.1));
  EXPECT_THAT(elbow.limits.upper, ElementsAre(2.6));
  EXPECT_THAT(elbow.limits.max_velocity, ElementsAre(3));
  const Joint& yaw = JointOf(import, "yaw");
  EXPECT_THAT(yaw.limits.lower, IsEmpty());
  EXPECT_THAT(yaw.limits.max_velocity, ElementsAre(2));
  EXPECT_EQ(yaw.link_mass_kg, 8);
  EXPECT_EQ(yaw.link_center_of_mass, Eigen::Vector3d(0, 0, 0.2));
  EXPECT_EQ(JointOf(import, "shoulder").link_mass_kg, 3);
  EXPECT_EQ(elbow.link_mass_kg, 0);
}

TEST(UrdfImportTest, TheRootLinkHasItsMassToo) {
  const UrdfImport import =
      Import(Robot("<link name=\"a\"><inertial><mass value=\"4\"/>"
                   "<origin xyz=\"1 2 3\"/></inertial></link>"));
  EXPECT_THAT(JointIds(*import.skeleton), ElementsAre("a"));
  EXPECT_EQ(import.skeleton->joint(0).link_mass_kg, 4);
  EXPECT_EQ(import.skeleton->joint(0).link_center_of_mass,
            Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfImportTest, ChainsOfMimicsFollowTheLast) {
  const UrdfImport import = Import(GripperArmUrdf());
  const Joint& left = JointOf(import, "finger_left");
  EXPECT_EQ(left.mimic->joint_id, "finger");
  const Joint& right = JointOf(import, "finger_right");
  EXPECT_EQ(right.mimic->joint_id, "finger");
  // -0.5 * (-1 * q + 0.002) + 0.01
  EXPECT_EQ(right.mimic->multiplier, 0.5);
  EXPECT_DOUBLE_EQ(right.mimic->offset, 0.009);
}

TEST(UrdfImportTest, FloatingAndPlanarJointsMove) {
  const UrdfImport import = Import(Robot(
      LinkText("a") + LinkText("b") + LinkText("c") +
      R"(<joint name="j" type="floating"><parent link="a"/><child link="b"/>
           <origin xyz="1 0 0"/></joint>
         <joint name="k" type="planar"><parent link="b"/><child link="c"/>
           <axis xyz="0 0 1"/></joint>)"));
  const Skeleton& skeleton = *import.skeleton;
  ASSERT_EQ(skeleton.position_count(), 10);
  Eigen::VectorXd pose = skeleton.rest_positions();
  EXPECT_EQ(EffectorPose(skeleton, pose, "c").translation,
            Eigen::Vector3d(1, 0, 0));
  pose.head<3>() << 0, 2, 0;
  pose.tail<3>() << 0.5, 0.25, 0;
  EXPECT_EQ(EffectorPose(skeleton, pose, "c").translation,
            Eigen::Vector3d(1.5, 2.25, 0));
}

TEST(UrdfImportTest, TheRestPoseIsInsideTheLimits) {
  const UrdfImport import = Import(GripperArmUrdf());
  const Skeleton& skeleton = *import.skeleton;
  Eigen::VectorXd rest = skeleton.rest_positions();
  EXPECT_EQ(rest[skeleton.span(skeleton.FindJoint("elbow")).position_offset],
            0.1);
  EXPECT_EQ(rest.cwiseAbs().sum(), 0.1);
  EXPECT_EQ(ClampToLimits(skeleton, rest), 0);
  EXPECT_THAT(import.warnings,
              Contains("zero is outside the limits: the rest pose has another "
                       "value for \"elbow\""));
}

TEST(UrdfImportTest, ANameThatAJointHasIsNoEndEffector) {
  // "b" is the joint of link b and "c" is not the joint of link c.
  const UrdfImport import = Import(
      Robot(LinkText("a") + LinkText("b") + LinkText("c") + LinkText("d") +
            JointText("b", "a", "b", "<origin xyz=\"1 0 0\"/>") +
            JointText("x", "b", "c", "<origin xyz=\"1 0 0\"/>") +
            JointText("c", "c", "d", "<origin xyz=\"1 0 0\"/>")));
  EXPECT_THAT(JointIds(*import.skeleton), ElementsAre("a", "b", "x", "c"));
  EXPECT_THAT(EndEffectorIds(*import.skeleton), ElementsAre("c.link", "d"));
  const Eigen::VectorXd rest = import.skeleton->rest_positions();
  EXPECT_EQ(EffectorPose(*import.skeleton, rest, "b").translation.x(), 1);
  EXPECT_EQ(EffectorPose(*import.skeleton, rest, "c.link").translation.x(), 2);
  EXPECT_EQ(EffectorPose(*import.skeleton, rest, "c").translation.x(), 3);
}

TEST(UrdfImportTest, ARootLinkCalledLikeAJointIsRenamed) {
  const UrdfImport import =
      Import(Robot(LinkText("j") + LinkText("b") + JointText("j", "j", "b")));
  EXPECT_THAT(JointIds(*import.skeleton), ElementsAre("j#2", "j"));
  EXPECT_THAT(import.warnings, ElementsAre("link \"j\" is called \"j#2\""));
}

TEST(UrdfImportTest, NamesThatAreNoIdsAreChangedAndReported) {
  const std::string long_name(70, 'x');
  const UrdfImport import = Import(Robot(
      LinkText("a") + LinkText(long_name + "1") + LinkText(long_name + "2") +
      LinkText("M\xFCnze") + JointText(long_name + "j", "a", long_name + "1") +
      JointText(long_name + "k", "a", long_name + "2") +
      JointText("h\xFFnge", "a", "M\xFCnze",
                absl::StrCat("<mimic joint=\"", long_name, "k\"/>"))));
  EXPECT_THAT(JointIds(*import.skeleton),
              ElementsAre("a", std::string(63, 'x'),
                          absl::StrCat(std::string(61, 'x'), "#2"),
                          "h\xEF\xBF\xBDnge"));
  EXPECT_THAT(EndEffectorIds(*import.skeleton),
              ElementsAre(absl::StrCat(std::string(61, 'x'), "#3"),
                          absl::StrCat(std::string(61, 'x'), "#4"),
                          "M\xEF\xBF\xBDnze"));
  EXPECT_EQ(import.skeleton->joint(3).mimic->joint_id,
            import.skeleton->joint(2).id);
  EXPECT_THAT(import.warnings, SizeIs(6));
  for (const std::string& warning : import.warnings) {
    EXPECT_THAT(warning, HasSubstr("is called"));
  }
}

TEST(UrdfImportTest, WarningsOfTheDocumentComeFirst) {
  UrdfDocument document = Read(GripperArmUrdf());
  document.warnings = {"line 1: odd"};
  const absl::StatusOr<UrdfImport> import = ImportUrdf(document);
  ASSERT_TRUE(import.ok());
  EXPECT_EQ(import->warnings[0], "line 1: odd");
  EXPECT_THAT(import->warnings, SizeIs(3));
}

TEST(UrdfImportTest, RefusesNamesThatComeTwice) {
  EXPECT_THAT(
      Lines(Robot(LinkText("a") + LinkText("b") + LinkText("a") +
                  JointText("j", "a", "b") + JointText("j", "a", "b"))),
      ElementsAre("line 4: link \"a\": the one on line 2 has that name",
                  "line 6: joint \"j\": the one on line 5 has that name",
                  "line 6: joint \"j\": link \"b\" is moved by joint \"j\" "
                  "already"));
}

TEST(UrdfImportTest, RefusesNamesThatNobodyHas) {
  EXPECT_THAT(Lines(Robot(LinkText("a") +
                          JointText("j", "x", "y", "<mimic joint=\"k\"/>"))),
              ElementsAre("line 3: joint \"j\": no link \"x\"",
                          "line 3: joint \"j\": no link \"y\"",
                          "line 3: joint \"j\": no joint \"k\""));
}

TEST(UrdfImportTest, RefusesLinksThatTwoJointsMove) {
  EXPECT_THAT(
      Lines(Robot(LinkText("a") + LinkText("b") + JointText("j", "a", "b") +
                  JointText("k", "a", "b"))),
      ElementsAre("line 5: joint \"k\": link \"b\" is moved by joint \"j\" "
                  "already"));
}

TEST(UrdfImportTest, RefusesOtherThanOneRoot) {
  EXPECT_THAT(
      Lines(Robot("")),
      ElementsAre("robot: want one link that no joint moves, got none"));
  EXPECT_THAT(
      Lines(Robot(LinkText("a") + JointText("j", "a", "a"))),
      ElementsAre("robot: want one link that no joint moves, got none"));
  EXPECT_THAT(Lines(Robot(LinkText("a") + LinkText("b"))),
              ElementsAre("robot: want one link that no joint moves, got 2: "
                          "\"a\" on line 2, \"b\" on line 3"));
  std::string many;
  for (int i = 0; i < 9; ++i) many += LinkText(absl::StrCat("l", i));
  EXPECT_THAT(Lines(Robot(many)),
              ElementsAre(HasSubstr("\"l4\" on line 6, ...")));
}

TEST(UrdfImportTest, RefusesLinksInACircle) {
  EXPECT_THAT(
      Lines(Robot(LinkText("root") + LinkText("a") + LinkText("b") +
                  JointText("j", "a", "b") + JointText("k", "b", "a"))),
      ElementsAre("line 5: joint \"j\" does not hang from the root link: the "
                  "links are in a circle",
                  "line 6: joint \"k\" does not hang from the root link: the "
                  "links are in a circle"));
}

TEST(UrdfImportTest, RefusesMimicsThatFollowNoNumber) {
  const std::string links = LinkText("a") + LinkText("b") + LinkText("c");
  EXPECT_THAT(
      Lines(Robot(links + JointText("j", "a", "b", "<mimic joint=\"j\"/>") +
                  JointText("k", "a", "c", "<mimic joint=\"j\"/>"))),
      ElementsAre("line 5: <mimic> of joint \"j\": joints that mimic each "
                  "other in a circle"));
  EXPECT_THAT(
      Lines(Robot(links + JointText("j", "a", "b", "<mimic joint=\"k\"/>") +
                  JointText("k", "a", "c", "<mimic joint=\"j\"/>"))),
      SizeIs(2));
  EXPECT_THAT(
      Lines(Robot(links + JointText("j", "a", "b", "<mimic joint=\"k\"/>") +
                  "<joint name=\"k\" type=\"fixed\"><parent link=\"a\"/>"
                  "<child link=\"c\"/></joint>")),
      ElementsAre("line 5: <mimic> of joint \"j\": joint \"k\" is fixed, and "
                  "has no number to follow"));
  EXPECT_THAT(
      Lines(Robot(
          links + LinkText("d") +
          JointText("j", "a", "b", "<mimic joint=\"k\" multiplier=\"1e9\"/>") +
          JointText("k", "a", "c", "<mimic joint=\"l\" multiplier=\"2\"/>") +
          JointText("l", "a", "d"))),
      ElementsAre(HasSubstr("grows beyond 1e9")));
}

TEST(UrdfImportTest, AMimicOfMultiplierZeroStandsStill) {
  const UrdfImport import = Import(Robot(
      LinkText("a") + LinkText("b") + LinkText("c") + JointText("j", "a", "b") +
      R"(<joint name="k" type="prismatic"><parent link="a"/><child link="c"/>
         <limit lower="0" upper="1"/>
         <mimic joint="j" multiplier="0" offset="0.5"/></joint>)"));
  Eigen::VectorXd pose(1);
  pose << 1.25;
  EXPECT_EQ(EffectorPose(*import.skeleton, pose, "c").translation,
            Eigen::Vector3d(0.5, 0, 0));
}

TEST(UrdfImportTest, BoundsHoldOnBothSides) {
  std::string text = LinkText("l0");
  for (int i = 1; i < 5; ++i) {
    text += LinkText(absl::StrCat("l", i)) + JointText(absl::StrCat("j", i),
                                                       absl::StrCat("l", i - 1),
                                                       absl::StrCat("l", i));
  }
  SkeletonBounds bounds;
  bounds.max_joints = 5;
  bounds.max_depth = 5;
  bounds.max_end_effectors = 4;
  EXPECT_THAT(Lines(Robot(text), bounds), IsEmpty());
  bounds.max_depth = 4;
  EXPECT_THAT(Lines(Robot(text), bounds),
              ElementsAre("line 10: joint \"j4\": deeper than 4 joints"));
  bounds = {.max_joints = 4};
  EXPECT_THAT(Lines(Robot(text), bounds),
              ElementsAre("joints: want at most 4, got 5"));
}

}  // namespace
}  // namespace gelenk
