#include "gelenk/formats/bvh_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/substitute.h"
#include "gelenk/formats/bvh_reader.h"

namespace gelenk {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pointwise;

constexpr char kSix[] =
    "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";

BvhImport Import(absl::string_view text, std::optional<double> unit_m = 1) {
  const absl::StatusOr<BvhDocument> document = ReadBvh(text);
  EXPECT_TRUE(document.ok()) << document.status();
  BvhImportOptions options;
  options.unit_m = unit_m;
  absl::StatusOr<BvhImport> import = ImportBvh(*document, options);
  EXPECT_TRUE(import.ok()) << import.status();
  return *std::move(import);
}

std::string File(absl::string_view root, absl::string_view rows) {
  return absl::StrCat("HIERARCHY\nROOT root\n{\n", root,
                      "\n}\nMOTION\nFrames: ", rows);
}

std::vector<std::string> Ids(const BvhImport& import) {
  std::vector<std::string> ids;
  for (const Joint& joint : import.skeleton->joints()) ids.push_back(joint.id);
  return ids;
}

std::vector<double> Rest(const BvhImport& import) {
  const Eigen::VectorXd& rest = import.skeleton->rest_positions();
  return {rest.begin(), rest.end()};
}

TEST(BvhImportTest, RootPositionsReplaceItsOffset) {
  const BvhImport import = Import(File(absl::StrCat("OFFSET 1 94 -3\n", kSix),
                                       "1\nFrame Time: 1\n5 88 6 0 0 0\n"),
                                  0.01);
  const Joint& root = import.skeleton->joint(0);
  EXPECT_EQ(root.type, JointType::kFree);
  EXPECT_TRUE(root.parent_from_joint.translation.isZero(0));
  // The OFFSET is where the rest pose stands.
  EXPECT_THAT(Rest(import),
              Pointwise(DoubleEq(), {0.01, 0.94, -0.03, 0., 0., 0., 1.}));
}

TEST(BvhImportTest, ARootWithoutPositionsStaysAtItsOffset) {
  const BvhImport import =
      Import(File("OFFSET 1 2 3 CHANNELS 3 Zrotation Xrotation Zrotation",
                  "0\nFrame Time: 1\n"));
  const Joint& root = import.skeleton->joint(0);
  EXPECT_EQ(root.type, JointType::kSpherical);
  EXPECT_EQ(root.parent_from_joint.translation, Eigen::Vector3d(1, 2, 3));
}

// A child with six channels below a fixed root, two frames of positions.
BvhImport ImportChild(absl::string_view first, absl::string_view second) {
  return Import(File(
      absl::StrCat("OFFSET 0 0 0\nJOINT child\n{\nOFFSET 0 2 0\n", kSix, "}"),
      absl::StrCat("2\nFrame Time: 1\n", first, " 0 0 0\n", second,
                   " 0 90 0\n")));
}

TEST(BvhImportTest, PositionsThatStayAreTheOffset) {
  const BvhImport import = ImportChild("1 2 3", "1 2 3");
  EXPECT_EQ(import.skeleton->joint(0).type, JointType::kFixed);
  const Joint& child = import.skeleton->joint(1);
  EXPECT_EQ(child.type, JointType::kSpherical);
  EXPECT_EQ(child.parent_from_joint.translation, Eigen::Vector3d(1, 2, 3));
}

TEST(BvhImportTest, PositionsThatMoveMakeAFreeJoint) {
  // One part in a million of the size, 3.7, from both sides.
  EXPECT_EQ(ImportChild("1 2 3", "1 2 3.000003").skeleton->joint(1).type,
            JointType::kSpherical);
  const BvhImport import = ImportChild("1 2 3", "1 2 3.000005");
  EXPECT_EQ(import.skeleton->joint(1).type, JointType::kFree);
  EXPECT_THAT(Rest(import), ElementsAre(0, 2, 0, 0, 0, 0, 1));
}

TEST(BvhImportTest, SixChannelsWithoutFramesKeepTheOffset) {
  const BvhImport import = Import(File(
      absl::StrCat("OFFSET 0 0 0\nJOINT child\n{\nOFFSET 0 2 0\n", kSix, "}"),
      "0\nFrame Time: 1\n"));
  const Joint& child = import.skeleton->joint(1);
  EXPECT_EQ(child.type, JointType::kSpherical);
  EXPECT_EQ(child.parent_from_joint.translation, Eigen::Vector3d(0, 2, 0));
}

TEST(BvhImportTest, OtherChannelsBecomeAChain) {
  const BvhImport import = Import(
      File("OFFSET 1 2 3 CHANNELS 4 Zrotation Yposition Xrotation Xposition\n"
           "JOINT knee { OFFSET 0 -1 0 CHANNELS 1 Xrotation }",
           "1\nFrame Time: 1\n90 5 30 6 45\n"),
      0.5);
  EXPECT_THAT(Ids(import), ElementsAre("root.Yposition", "root.Xposition",
                                       "root.Zrotation", "root", "knee"));
  EXPECT_THAT(import.joints, ElementsAre(3, 4));
  const Skeleton& skeleton = *import.skeleton;
  EXPECT_EQ(skeleton.joint(0).type, JointType::kPrismatic);
  EXPECT_EQ(skeleton.joint(0).axis, Eigen::Vector3d::UnitY());
  // What moves is not offset, what does not is.
  EXPECT_EQ(skeleton.joint(0).parent_from_joint.translation,
            Eigen::Vector3d(0, 0, 1.5));
  EXPECT_EQ(skeleton.joint(3).type, JointType::kRevolute);
  EXPECT_EQ(skeleton.joint(3).axis, Eigen::Vector3d::UnitX());
  EXPECT_EQ(skeleton.joint(4).parent_id, "root");
  EXPECT_THAT(Rest(import), ElementsAre(1, 0.5, 0, 0, 0));
}

TEST(BvhImportTest, AFullRotationEndsAChain) {
  const BvhImport import = Import(
      File("OFFSET 0 0 0 CHANNELS 4 Yposition Zrotation Xrotation Yrotation",
           "0\nFrame Time: 1\n"));
  EXPECT_THAT(Ids(import), ElementsAre("root.Yposition", "root"));
  EXPECT_EQ(import.skeleton->joint(1).type, JointType::kSpherical);
}

TEST(BvhImportTest, AnglesThatDoNotReachEveryRotationAreAChain) {
  const BvhImport import =
      Import(File("OFFSET 0 0 0 CHANNELS 3 Xrotation Xrotation Yrotation",
                  "0\nFrame Time: 1\n"));
  EXPECT_THAT(Ids(import),
              ElementsAre("root.Xrotation", "root.Xrotation#2", "root"));
}

TEST(BvhImportTest, EndSitesAreEndEffectors) {
  const BvhImport import =
      Import(File("OFFSET 0 0 0\nEnd Site { OFFSET 0 0 1 }\n"
                  "End Site Toe Tip\n{ OFFSET 0 0 2 }\n"
                  "End Site root\n{ OFFSET 0 0 3 }\n",
                  "0\nFrame Time: 1\n"),
             0.1);
  ASSERT_EQ(import.skeleton->end_effectors().size(), 3);
  EXPECT_EQ(import.skeleton->end_effectors()[0].id, "root.end");
  EXPECT_EQ(import.skeleton->end_effectors()[1].id, "Toe Tip");
  EXPECT_EQ(import.skeleton->end_effectors()[2].id, "root.end#2");
  EXPECT_EQ(
      import.skeleton->end_effectors()[1].joint_from_end_effector.translation,
      Eigen::Vector3d(0, 0, 0.2));
}

TEST(BvhImportTest, NamesThatAreNoIdsAreChangedAndReported) {
  const std::string long_name(70, 'x');
  const BvhImport import = Import(
      File(absl::StrCat("OFFSET 0 0 0\nJOINT ", long_name,
                        "\n{ OFFSET 0 0 0 }\nJOINT ", long_name,
                        "y\n"
                        "{ OFFSET 0 0 0 CHANNELS 2 Xrotation Yrotation }\n"
                        "JOINT M\xFCnze\n{ OFFSET 0 0 0 }"),
           "0\nFrame Time: 1\n"));
  EXPECT_THAT(Ids(import),
              ElementsAre("root", std::string(63, 'x'),
                          absl::StrCat(std::string(53, 'x'), ".Xrotation"),
                          absl::StrCat(std::string(61, 'x'), "#2"),
                          "M\xEF\xBF\xBDnze"));
  EXPECT_THAT(import.warnings,
              ElementsAre(HasSubstr("is called"), HasSubstr("is called"),
                          HasSubstr("is called")));
}

TEST(BvhImportTest, TakesJointsWithoutLengthAndNamesOfEveryKind) {
  const BvhImport import =
      Import(File("OFFSET 0 0 0\nJOINT mixamorig:Hips\n{ OFFSET 0 0 0 "
                  "CHANNELS 3 Yrotation Zrotation Xrotation\n"
                  "JOINT Bip01 L Hand\n{ OFFSET 0 0 0 } }",
                  "1\nFrame Time: 1\n1 2 3\n"));
  EXPECT_THAT(Ids(import),
              ElementsAre("root", "mixamorig:Hips", "Bip01 L Hand"));
  EXPECT_THAT(import.warnings, IsEmpty());
}

TEST(BvhImportTest, RefusesSkeletonsThatAreTooLarge) {
  BvhDocument document;
  for (int i = 0; i < 600; ++i) {
    BvhJoint joint;
    joint.name = absl::StrCat("j", i);
    joint.parent = std::min(i, 1) - 1;
    joint.channels = {BvhChannel::kXrotation, BvhChannel::kYrotation};
    document.joints.push_back(joint);
  }
  document.motion.resize(1200, 0);
  const absl::StatusOr<BvhImport> import = ImportBvh(document, {1});
  EXPECT_THAT(std::string(import.status().message()),
              HasSubstr("joints: want at most 1024, got 1200"));
}

TEST(BvhImportTest, RefusesUnitsThatAreNoLength) {
  const absl::StatusOr<BvhDocument> document =
      ReadBvh(File("OFFSET 0 0 0", "0\nFrame Time: 1\n"));
  ASSERT_TRUE(document.ok());
  for (double unit_m : {0.0, -1.0, 1e7, double{NAN}, double{INFINITY}}) {
    const absl::StatusOr<BvhImport> import = ImportBvh(*document, {unit_m});
    EXPECT_EQ(import.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(import.status().message()), HasSubstr("unit_m"));
  }
  EXPECT_EQ(ImportBvh(BvhDocument()).status().code(),
            absl::StatusCode::kInvalidArgument);
}

// A body with +Y up in its rest pose, 17 * `scale` units from ankle to top.
std::string Body(double scale) {
  return absl::Substitute(R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation Zrotation
  JOINT LeftLeg { OFFSET $0 0 0
    JOINT LeftFoot { OFFSET 0 -$4 0 } }
  JOINT RightLeg { OFFSET -$0 0 0
    JOINT RightFoot { OFFSET 0 -$4 0 } }
  JOINT Spine { OFFSET 0 $2 0
    JOINT LeftHand { OFFSET $3 0 0 }
    JOINT RightHand { OFFSET -$3 0 0 }
    JOINT Head { OFFSET 0 $1 0
      End Site { OFFSET 0 $0 0 } } }
}
)",
                          scale, 2 * scale, 5 * scale, 6 * scale, 8 * scale);
}

TEST(BvhImportTest, InfersTheUnitFromTheBodysHeight) {
  const struct {
    double scale;
    double unit_m;
    const char* words;
  } cases[] = {
      {0.1, 1, "1 m: the body is then 1.70 m tall"},
      {0.07, 1, "1 m: the body is then 1.19 m tall"},
      {10, 0.01, "1 cm: the body is then 1.70 m tall"},
      {12, 0.01, "1 cm: the body is then 2.04 m tall"},
      {100, 0.001, "1 mm: the body is then 1.70 m tall"},
      {4, 0.0254, "1 inch: the body is then 1.73 m tall"},
      // A child of 1.17 m in inches is no giant in another unit.
      {2.7, 0.0254, "1 inch: the body is then 1.17 m tall"},
      {0.33, 0.3048, "1 foot: the body is then 1.71 m tall"},
      {1.6, 0.056444, "CMU's 5.6444 cm: the body is then 1.54 m tall"},
  };
  for (const auto& c : cases) {
    const BvhImport import = Import(Body(c.scale), std::nullopt);
    EXPECT_EQ(import.unit_m, c.unit_m);
    EXPECT_THAT(import.warnings,
                ElementsAre(HasSubstr("no MOTION"), HasSubstr(c.words)));
  }
}

TEST(BvhImportTest, MeasuresOtherThingsFromTheGround) {
  const BvhImport import = Import(
      File(absl::StrCat("OFFSET 0 0 0\n", kSix, "JOINT tip { OFFSET 0 15 0 }"),
           "1\nFrame Time: 1\n5000 90 6 0 0 0\n"),
      std::nullopt);
  EXPECT_EQ(import.unit_m, 0.01);
  EXPECT_THAT(import.warnings,
              ElementsAre(HasSubstr("1 cm: it is then 1.05 m large")));
}

TEST(BvhImportTest, ANamelessPointIsTakenInCentimetres) {
  const BvhImport import =
      Import(File("OFFSET 0 0 0", "0\nFrame Time: 1\n"), std::nullopt);
  EXPECT_EQ(import.unit_m, 0.01);
  EXPECT_THAT(import.warnings, ElementsAre(HasSubstr("no extent")));
}

BvhImport ImportTurnedBody(absl::string_view angles) {
  return Import(
      absl::StrCat(Body(1), "MOTION\nFrames: 2\nFrame Time: 1\n0 0 0 ", angles,
                   "\n9 9 9 ", angles, "\n"),
      0.1);
}

TEST(BvhImportTest, TakesUpFromTheMotion) {
  const BvhImport upright = ImportTurnedBody("0 30 10");
  EXPECT_EQ(upright.skeleton->up(), Eigen::Vector3d::UnitY());
  EXPECT_THAT(upright.warnings, IsEmpty());

  const BvhImport z_up = ImportTurnedBody("90 20 0");
  EXPECT_EQ(z_up.skeleton->up(), Eigen::Vector3d::UnitZ());
  EXPECT_THAT(z_up.warnings, ElementsAre(HasSubstr("up is +Z")));

  const BvhImport x_down = ImportTurnedBody("0 0 90");
  EXPECT_EQ(x_down.skeleton->up(), -Eigen::Vector3d::UnitX());
  EXPECT_THAT(x_down.warnings, ElementsAre(HasSubstr("up is -X")));
  // Importers report, they do not turn.
  EXPECT_EQ(x_down.skeleton->joint(2).parent_from_joint.translation,
            z_up.skeleton->joint(2).parent_from_joint.translation);
}

TEST(BvhImportTest, UpThatIsNotClearIsPlusY) {
  const BvhImport import =
      Import(absl::StrCat(Body(1),
                          "MOTION\nFrames: 2\nFrame Time: 1\n0 0 0 90 0 0\n"
                          "0 0 0 -90 0 0\n"),
             0.1);
  EXPECT_EQ(import.skeleton->up(), Eigen::Vector3d::UnitY());
  EXPECT_THAT(import.warnings, ElementsAre(HasSubstr("not clearly above")));
}

}  // namespace
}  // namespace gelenk
