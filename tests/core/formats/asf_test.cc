// Acclaim's skeletons and motions, on a leg that was made up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gelenk/formats/amc_reader.h"
#include "gelenk/formats/asf_bvh.h"
#include "gelenk/formats/asf_reader.h"
#include "gelenk/formats/bvh_import.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::testing::Contains;
using testing::Fails;
using ::testing::HasSubstr;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
// Angles go through degrees and back.
constexpr double kRounding = 1e-12;

constexpr char kLeg[] = R"(# made up
:version 1.10
:name nobody
:units
  mass 1.0
  length 0.45
  angle deg
:documentation
  a leg: hip knee
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 1 2 3
  orientation 0 0 0
:bonedata
  begin
    id 1
    name hip
    direction 0 -1 0
    length 4
    axis 0 0 90 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           ( -60.0 70.0 )
  end
  begin
    id 2
    name knee
    direction 0 -0.6 0.8
    length 5
    axis 30 10 0 ZYX
    dof rx
  end
  begin
    id 3
    name nail
    direction 0 0 1
    length 0.5
    axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root hip
    hip knee
    knee nail
  end
)";

constexpr char kMotion[] = R"(#!OML:ASF made up
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 0 0 0
hip 0 0 0
knee 0
2
knee 45
hip 10 20 30
root 4 5 6 15 90 -20
)";

AsfDocument Leg() { return ReadAsf(kLeg).value(); }

TEST(AsfReaderTest, ReadsBonesInTheOrderOfTheTree) {
  const AsfDocument leg = Leg();
  ASSERT_EQ(leg.bones.size(), 4u);
  EXPECT_EQ(leg.root_position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(leg.bones[0].dofs.size(), 6u);
  EXPECT_EQ(leg.bones[2].name, "knee");
  EXPECT_EQ(leg.bones[2].parent, 1);
  EXPECT_EQ(leg.bones[2].length, 5);
  EXPECT_EQ(leg.bones[2].axis_order, (EulerAxes{2, 1, 0}));
  EXPECT_EQ(leg.bones[3].dofs.size(), 0u);
  EXPECT_EQ(leg.dof_count(), 10);
  EXPECT_THAT(leg.warnings, Contains("limits of bones are not read"));
}

TEST(AsfReaderTest, TakesAnyLineEndAndCaseAndOtherSections) {
  const std::string text = absl::StrCat(
      "\xEF\xBB\xBF",
      absl::StrReplaceAll(kLeg, {{"\n", "\r\n"},
                                 {":root", ":ROOT"},
                                 {":documentation", ":skin\nx\n:documentation"},
                                 {"id 2", "id 2 # the second"}}));
  const auto leg = ReadAsf(text);
  ASSERT_TRUE(leg.ok()) << leg.status();
  EXPECT_EQ(leg->bones.size(), 4u);
  EXPECT_THAT(leg->warnings, Contains("section \":skin\" is not read"));
}

TEST(AsfReaderTest, SaysWhereAFileIsMalformed) {
  const struct {
    const char* right;
    const char* wrong;
    const char* words;
  } mistakes[] = {
      {":version 1.10", "version 1.10", "line 2, column 1: expected a section"},
      {"length 0.45", "length x", "line 6, column 10: expected a number"},
      {"angle deg", "angle grad", "expected deg or rad"},
      {":root", ":roots", "expected a section :root"},
      {"axis XYZ\n  position", "axis XYX\n  position", "an order of axes"},
      {"order TX", "order TX TX", "line 11, column 12: expected each number"},
      {"direction 0 -1 0", "direction 0 -1",
       "line 20, column 5: expected a nu"},
      {"direction 0 -1 0", "direction 0 0 0", "a direction of bone \"hip\""},
      {"length 5", "length -5", "expected a length >= 0"},
      {"name knee", "name hip", "no second bone \"hip\""},
      {"dof rx\n", "dof rx l\n", "a bone whose length stays"},
      {"dof rx\n", "dof tx\n", "rotations only below the root"},
      {"( -60.0 70.0 )", "( -60.0 70.0", "expected"},
      {"hip knee\n    knee", "hip knee\n    shin", "the name of a bone"},
      {"knee nail\n  end", "knee hip\n  end", "hangs on nothing yet"},
      {"root hip\n", "root root\n", "hangs on nothing yet"},
      {"root hip\n", "nail hip\n", "does not hang on the root"},
      {"knee nail\n  end", "knee nail\n", "end of file"},
  };
  for (const auto& mistake : mistakes) {
    const std::string text =
        absl::StrReplaceAll(kLeg, {{mistake.right, mistake.wrong}});
    ASSERT_NE(text, kLeg) << mistake.right;
    EXPECT_THAT(ReadAsf(text).status(), Fails(kInvalid, mistake.words))
        << mistake.wrong;
  }
}

TEST(AsfReaderTest, CutOffAnywhereItIsRefusedOrWhole) {
  const std::string text = kLeg;
  for (size_t size = 0; size + 5 < text.size(); ++size) {
    EXPECT_FALSE(ReadAsf(text.substr(0, size)).ok()) << size;
  }
}

TEST(AsfReaderTest, BoundsHoldFromBothSides) {
  BvhBounds bounds;
  bounds.max_joints = 4;
  bounds.max_depth = 4;
  EXPECT_TRUE(ReadAsf(kLeg, bounds).ok());
  bounds.max_joints = 3;
  EXPECT_THAT(ReadAsf(kLeg, bounds).status(), Fails(kInvalid, "at most 3"));
  bounds.max_joints = 4;
  bounds.max_depth = 3;
  EXPECT_THAT(ReadAsf(kLeg, bounds).status(), Fails(kInvalid, "more than 3"));
  bounds.max_bytes = 10;
  EXPECT_THAT(ReadAsf(kLeg, bounds).status(), Fails(kInvalid, "at most 10"));
}

TEST(AmcReaderTest, ReadsFramesInAnyOrderOfBones) {
  const auto motion = ReadAmc(kMotion, Leg());
  ASSERT_TRUE(motion.ok()) << motion.status();
  ASSERT_EQ(motion->numbers.cols(), 2);
  EXPECT_EQ(motion->numbers(1, 1), 5);
  EXPECT_DOUBLE_EQ(motion->numbers(9, 1), M_PI / 4);
  const auto radians =
      ReadAmc(absl::StrReplaceAll(kMotion, {{":DEGREES", ":RADIANS"}}), Leg());
  EXPECT_EQ(radians->numbers(9, 1), 45);
}

TEST(AmcReaderTest, SaysWhereAFileIsMalformed) {
  const struct {
    const char* right;
    const char* wrong;
    const char* words;
  } mistakes[] = {
      {"knee 45", "shin 45", "line 9, column 1: expected bone root of frame 2"},
      {"knee 45", "knee x", "line 9, column 6: expected a number"},
      {"hip 10 20 30", "hip 10 20", "expected a number"},
      {"\n2\n", "\n7\n", "frame 2 before this, not 7"},
      {"knee 45\n", "", "bone knee of frame 2"},
      {"knee 45\n", "knee 45\nknee 45\n", "each bone once"},
  };
  for (const auto& mistake : mistakes) {
    const std::string text =
        absl::StrReplaceAll(kMotion, {{mistake.right, mistake.wrong}});
    ASSERT_NE(text, kMotion);
    EXPECT_THAT(ReadAmc(text, Leg()).status(), Fails(kInvalid, mistake.words))
        << mistake.wrong;
  }
  BvhBounds bounds;
  bounds.max_frames = 1;
  EXPECT_THAT(ReadAmc(kMotion, Leg(), bounds).status(),
              Fails(kInvalid, "at most 1 frames"));
}

// Fixed turns, X first, as the format has them in the order XYZ.
Eigen::Matrix3d Xyz(double x, double y, double z) {
  constexpr double kRad = M_PI / 180;
  return (Eigen::AngleAxisd(z * kRad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(y * kRad, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(x * kRad, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

TEST(AsfBvhTest, JointsAreWhereTheFormatSays) {
  const AsfDocument leg = Leg();
  const BvhDocument document = BvhFromAsf(leg, ReadAmc(kMotion, leg).value());
  EXPECT_THAT(document.warnings,
              Contains("1 bones of one or two angles are joints that turn all "
                       "ways"));
  const BvhImport import = ImportBvh(document, {1}).value();
  const Eigen::MatrixXd poses = PosesFromBvh(document, import).value();
  // By hand: R = R(parent) C M C^-1, the end = the start + R * direction *
  // length.
  const Eigen::Matrix3d root = Xyz(15, 90, -20);
  const Eigen::Matrix3d hip_axis = Xyz(0, 0, 90);
  const Eigen::Matrix3d hip =
      root * hip_axis * Xyz(10, 20, 30) * hip_axis.transpose();
  // ZYX: Z first.
  const Eigen::Matrix3d knee_axis = Xyz(30, 0, 0) * Xyz(0, 10, 0);
  const Eigen::Matrix3d knee =
      hip * knee_axis * Xyz(45, 0, 0) * knee_axis.transpose();
  const Eigen::Vector3d start(1 + 4, 2 + 5, 3 + 6);
  const Eigen::Vector3d at_knee = start + hip * Eigen::Vector3d(0, -4, 0);
  const Eigen::Vector3d at_nail = at_knee + knee * Eigen::Vector3d(0, -3, 4);
  WorldTransforms frames;
  ForwardKinematics(*import.skeleton, poses.col(1), frames);
  const auto joint = [&](const char* id) {
    return import.skeleton->FindJoint(id);
  };
  EXPECT_LT((frames[joint("hip")].translation - start).norm(), kRounding);
  EXPECT_LT((frames[joint("knee")].translation - at_knee).norm(), kRounding);
  EXPECT_LT((frames[joint("nail")].translation - at_nail).norm(), kRounding);
  EXPECT_LT((frames[joint("nail")].rotation.toRotationMatrix() - knee).norm(),
            kRounding);
}

TEST(AsfBvhTest, ASkeletonAloneStandsAtRest) {
  const BvhDocument document = BvhFromAsf(Leg(), {});
  EXPECT_EQ(document.frame_count(), 0);
  EXPECT_EQ(document.joints[3].offset, Eigen::Vector3d(0, -3, 4));
  EXPECT_EQ(document.joints[3].end_sites[0].offset, Eigen::Vector3d(0, 0, 0.5));
  EXPECT_TRUE(ImportBvh(document).ok());
}

}  // namespace
}  // namespace gelenk
