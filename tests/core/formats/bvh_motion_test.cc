#include "gelenk/formats/bvh_motion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/formats/bvh_writer.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/core/formats/bvh_oracle.h"

namespace gelenk {
namespace {

using ::testing::HasSubstr;

// What a round trip may change: rad, and units of the file.
constexpr double kRotationTolerance = 1e-9;
constexpr double kPositionTolerance = 1e-9;

void ExpectSame(const BvhDocument& a, const BvhDocument& b) {
  ASSERT_EQ(a.frame_count(), b.frame_count());
  const BvhDifference worst = CompareMotion(a, b);
  EXPECT_LT(worst.rotation, kRotationTolerance);
  EXPECT_LT(worst.position, kPositionTolerance);
}

// The document after the way through poses and text.
BvhDocument ThereAndBack(const BvhDocument& document, double unit_m) {
  const absl::StatusOr<BvhImport> import = ImportBvh(document, {unit_m});
  EXPECT_TRUE(import.ok()) << import.status();
  const absl::StatusOr<Eigen::MatrixXd> poses = PosesFromBvh(document, *import);
  EXPECT_TRUE(poses.ok()) << poses.status();
  const absl::StatusOr<BvhDocument> written =
      BvhFromPoses(document, *import, *poses);
  EXPECT_TRUE(written.ok()) << written.status();
  const absl::StatusOr<BvhDocument> read = ReadBvh(WriteBvh(*written));
  EXPECT_TRUE(read.ok()) << read.status();
  return *read;
}

class DocumentSource {
 public:
  explicit DocumentSource(int seed) : random_(seed) {}

  int Below(int end) {
    return std::uniform_int_distribution<int>(0, end - 1)(random_);
  }
  double Within(double largest) {
    return std::uniform_real_distribution<>(-largest, largest)(random_);
  }

  // A chain of joints with the given channels that turn and move smoothly by
  // any amount.
  BvhDocument Chain(const std::vector<std::vector<BvhChannel>>& channels,
                    int frames) {
    BvhDocument document;
    for (const auto& list : channels) {
      BvhJoint joint;
      joint.name = absl::StrCat("j", document.joints.size());
      joint.parent = static_cast<int>(document.joints.size()) - 1;
      joint.offset = {Within(5), Within(5), Within(5)};
      joint.channels = list;
      document.joints.push_back(joint);
    }
    document.motion.resize(document.channel_count(), frames);
    for (int row = 0; row < document.motion.rows(); ++row) {
      const double start = Within(400);
      const double speed = Within(30);
      for (int frame = 0; frame < frames; ++frame) {
        document.motion(row, frame) = start + speed * frame + Within(1);
      }
    }
    return document;
  }

  // Any mixture of channels that the reader takes.
  std::vector<BvhChannel> AnyChannels() {
    std::vector<BvhChannel> channels;
    for (int axis = 0; axis < 3; ++axis) {
      if (Below(3) == 0) channels.push_back(static_cast<BvhChannel>(axis));
    }
    for (int count = Below(4); count > 0; --count) {
      channels.push_back(static_cast<BvhChannel>(3 + Below(3)));
    }
    std::shuffle(channels.begin(), channels.end(), random_);
    return channels;
  }

 private:
  std::mt19937 random_;
};

std::vector<std::vector<BvhChannel>> AllFullRotations() {
  std::vector<std::vector<BvhChannel>> orders;
  for (int i = 3; i < 6; ++i) {
    for (int j = 3; j < 6; ++j) {
      for (int k = 3; k < 6; ++k) {
        if (i == j || j == k) continue;
        orders.push_back({static_cast<BvhChannel>(i),
                          static_cast<BvhChannel>(j),
                          static_cast<BvhChannel>(k)});
      }
    }
  }
  return orders;
}

TEST(BvhMotionTest, EveryOrderOfRotationComesBack) {
  DocumentSource source(3);
  for (const auto& order : AllFullRotations()) {
    std::vector<BvhChannel> root = order;
    root.insert(root.begin() + source.Below(4),
                {BvhChannel::kZposition, BvhChannel::kXposition,
                 BvhChannel::kYposition});
    const BvhDocument document = source.Chain({root, order, order}, 40);
    const BvhDocument back = ThereAndBack(document, 0.0254);
    ExpectSame(document, back);
    EXPECT_EQ(back.joints[0].channels, root);
  }
}

TEST(BvhMotionTest, AnyMixtureOfChannelsComesBack) {
  DocumentSource source(4);
  for (int round = 0; round < 300; ++round) {
    std::vector<std::vector<BvhChannel>> channels(1 + source.Below(6));
    for (auto& list : channels) list = source.AnyChannels();
    const BvhDocument document = source.Chain(channels, source.Below(6));
    ExpectSame(document, ThereAndBack(document, 0.056444));
  }
}

TEST(BvhMotionTest, PosesStandWhereTheFileSays) {
  DocumentSource source(5);
  constexpr double kUnit = 0.01;
  for (int round = 0; round < 200; ++round) {
    std::vector<std::vector<BvhChannel>> channels(1 + source.Below(6));
    for (auto& list : channels) list = source.AnyChannels();
    const BvhDocument document = source.Chain(channels, 3);
    const absl::StatusOr<BvhImport> import = ImportBvh(document, {kUnit});
    ASSERT_TRUE(import.ok()) << import.status();
    const absl::StatusOr<Eigen::MatrixXd> poses =
        PosesFromBvh(document, *import);
    ASSERT_TRUE(poses.ok()) << poses.status();
    WorldTransforms world_from_joints;
    for (int frame = 0; frame < document.frame_count(); ++frame) {
      ForwardKinematics(*import->skeleton, poses->col(frame),
                        world_from_joints);
      const auto expected = OracleWorldFromJoints(document, frame);
      for (size_t i = 0; i < expected.size(); ++i) {
        const RigidTransform& actual = world_from_joints[import->joints[i]];
        EXPECT_LT(
            (actual.translation - kUnit * expected[i].translation()).norm(),
            1e-12);
        EXPECT_LT((actual.rotation.matrix() - expected[i].linear()).norm(),
                  1e-12);
      }
    }
  }
}

TEST(BvhMotionTest, RestPositionsAreTheFilesRestPose) {
  DocumentSource source(6);
  BvhDocument document = source.Chain(
      {source.AnyChannels(), source.AnyChannels(), source.AnyChannels()}, 4);
  const absl::StatusOr<BvhImport> import = ImportBvh(document, {1});
  ASSERT_TRUE(import.ok()) << import.status();
  // In the rest pose all angles are zero and positions are the OFFSETs.
  document.motion.setZero();
  int row = 0;
  for (const BvhJoint& joint : document.joints) {
    for (BvhChannel channel : joint.channels) {
      if (IsPosition(channel)) {
        document.motion(row, 0) = joint.offset[AxisOf(channel)];
      }
      ++row;
    }
  }
  WorldTransforms world_from_joints;
  ForwardKinematics(*import->skeleton, import->skeleton->rest_positions(),
                    world_from_joints);
  const auto expected = OracleWorldFromJoints(document, 0);
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT((world_from_joints[import->joints[i]].translation -
               expected[i].translation())
                  .norm(),
              1e-12);
  }
}

// One joint of three rotations; rows of angles in degrees.
BvhDocument OneJoint(const std::vector<Eigen::Vector3d>& rows) {
  BvhDocument document;
  BvhJoint joint;
  joint.name = "neck";
  joint.channels = {BvhChannel::kZrotation, BvhChannel::kXrotation,
                    BvhChannel::kYrotation};
  document.joints.push_back(joint);
  document.motion.resize(3, rows.size());
  for (size_t i = 0; i < rows.size(); ++i) document.motion.col(i) = rows[i];
  return document;
}

TEST(BvhMotionTest, WrappedAnglesBecomeContinuous) {
  // A steady turn, written within half a turn as many exporters do.
  std::vector<Eigen::Vector3d> rows;
  for (int i = 0; i < 200; ++i) {
    rows.push_back({std::remainder(170 + 7 * i, 360), 20, 10});
  }
  const BvhDocument document = OneJoint(rows);
  const absl::StatusOr<BvhImport> import = ImportBvh(document, {1});
  ASSERT_TRUE(import.ok());
  const absl::StatusOr<Eigen::MatrixXd> poses = PosesFromBvh(document, *import);
  ASSERT_TRUE(poses.ok());
  for (int i = 1; i < poses->cols(); ++i) {
    // 7 degrees are 0.061 in quaternion length.
    EXPECT_LT((poses->col(i) - poses->col(i - 1)).norm(), 0.07);
  }
  const absl::StatusOr<BvhDocument> back =
      BvhFromPoses(document, *import, *poses);
  ASSERT_TRUE(back.ok());
  for (int i = 0; i < 200; ++i) {
    EXPECT_NEAR(back->motion(0, i), 170 + 7 * i, 1e-9);
    EXPECT_NEAR(back->motion(1, i), 20, 1e-9);
  }
}

TEST(BvhMotionTest, PassesThroughGimbalLockWithoutLosingTheRotation) {
  std::vector<Eigen::Vector3d> rows;
  for (int i = 0; i <= 60; ++i) {
    rows.push_back({10.0 + i, 60.0 + i, -5.0 - i});
  }
  const BvhDocument document = OneJoint(rows);
  const BvhDocument back = ThereAndBack(document, 1);
  ExpectSame(document, back);
  for (int i = 1; i <= 60; ++i) {
    EXPECT_LT((back.motion.col(i) - back.motion.col(i - 1)).norm(), 5) << i;
  }
}

TEST(BvhMotionTest, RefusesPosesOfAnotherSkeleton) {
  const BvhDocument document = OneJoint({{1, 2, 3}});
  const absl::StatusOr<BvhImport> import = ImportBvh(document, {1});
  ASSERT_TRUE(import.ok());
  Eigen::MatrixXd poses(5, 1);
  EXPECT_THAT(
      std::string(BvhFromPoses(document, *import, poses).status().message()),
      HasSubstr("poses: want 4 rows, got 5"));
  poses.setConstant(4, 2, 0.5);
  poses(2, 1) = NAN;
  EXPECT_THAT(
      std::string(BvhFromPoses(document, *import, poses).status().message()),
      HasSubstr("frame 1"));
  BvhDocument other = document;
  other.joints[0].channels.pop_back();
  EXPECT_EQ(PosesFromBvh(other, *import).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(BvhFromPoses(other, *import, poses).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace gelenk
