#include "gelenk/motion/mirror.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_cut.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/sampler.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/example_bodies.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::PersonWithFingers;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::WalkingBvh;
using ::testing::Contains;
using ::testing::IsEmpty;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;
constexpr double kRounding = 1e-11;

MotionClip Walk() {
  const BvhDocument document = ReadBvh(WalkingBvh(60)).value();
  return ClipFromBvh(document, ImportBvh(document).value()).value();
}

Eigen::VectorXd At(const MotionClip& clip, double time_s) {
  Eigen::VectorXd positions(clip.skeleton()->position_count());
  Sampler(clip).Sample(time_s, positions);
  return positions;
}

double Apart(const MotionClip& a, const MotionClip& b, double time_s) {
  Eigen::VectorXd change(a.skeleton()->velocity_count());
  Difference(*a.skeleton(), At(a, time_s), At(b, time_s), change);
  return change.cwiseAbs().maxCoeff();
}

TEST(MirrorTest, NamesOfTheOtherSide) {
  EXPECT_THAT(OtherSideNames("LeftHand"), Contains("RightHand"));
  EXPECT_THAT(OtherSideNames("mixamorig:RightArm"),
              Contains("mixamorig:LeftArm"));
  EXPECT_THAT(OtherSideNames("hand_l"), Contains("hand_r"));
  EXPECT_THAT(OtherSideNames("lHand"), Contains("rHand"));
  EXPECT_THAT(OtherSideNames("LWrist"), Contains("RWrist"));
  EXPECT_THAT(OtherSideNames("Bip01 L Hand"), Contains("Bip01 R Hand"));
  EXPECT_THAT(OtherSideNames("Hand.R"), Contains("Hand.L"));
  EXPECT_THAT(OtherSideNames("LeftLeg.Xrotation"),
              Contains("RightLeg.Xrotation"));
  EXPECT_THAT(OtherSideNames("Hips"), IsEmpty());
  EXPECT_THAT(OtherSideNames("collar"), IsEmpty());
}

TEST(MirrorTest, PairsABodyByNames) {
  const auto skeleton = PersonWithFingers();
  const MirrorMap map = FindMirrorMap(*skeleton).value();
  EXPECT_TRUE(map.by_names);
  EXPECT_THAT(map.unpaired, IsEmpty());
  EXPECT_LT(map.symmetry_error_m, 1e-9);
  EXPECT_EQ(map.partner[0], 0);
  int pairs = 0;
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    EXPECT_EQ(map.partner[map.partner[i]], i);
    pairs += map.partner[i] != i;
  }
  EXPECT_GT(pairs, 40);
}

// Every joint is where the mirror shows its partner.
TEST(MirrorTest, JointsStandWhereTheMirrorShowsThem) {
  const auto skeleton = PersonWithFingers();
  const MirrorMap map = FindMirrorMap(*skeleton).value();
  Random random(1);
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::VectorXd pose = RandomPose(random, *skeleton);
    Eigen::VectorXd mirrored = pose;
    MirrorPose(*skeleton, map, pose, mirrored);
    WorldTransforms frames, images;
    ForwardKinematics(*skeleton, pose, frames);
    ForwardKinematics(*skeleton, mirrored, images);
    for (int i = 0; i < skeleton->joint_count(); ++i) {
      const Eigen::Vector3d& at = frames[i].translation;
      const Eigen::Vector3d image =
          at - 2 * map.world_normal.dot(at) * map.world_normal;
      EXPECT_LT((images[map.partner[i]].translation - image).norm(), kRounding)
          << skeleton->joint(i).id;
    }
  }
}

TEST(MirrorTest, TwiceIsNothing) {
  const MotionClip walk = Walk();
  const MirrorMap map = FindMirrorMap(*walk.skeleton()).value();
  const MotionClip once = MirrorClip(walk, map).value();
  const MotionClip twice = MirrorClip(once, map).value();
  EXPECT_GT(Apart(walk, once, 0.3), 0.01);
  for (double time_s : {0.0, 0.3, 0.7, 1.1}) {
    EXPECT_LT(Apart(walk, twice, time_s), kRounding);
  }
  EXPECT_EQ(once.duration_s(), walk.duration_s());
}

// A robot's legs of hinges, whose axes are all +X, +Y or +Z in a common frame.
std::shared_ptr<const Skeleton> Legs() {
  SkeletonBuilder builder;
  const auto add = [&](const char* id, const char* parent, JointType type,
                       const Eigen::Vector3d& at, const Eigen::Vector3d& axis) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent;
    joint.type = type;
    joint.parent_from_joint.translation = at;
    joint.axis = axis;
    builder.AddJoint(std::move(joint));
  };
  const Eigen::Vector3d x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  add("a", "", JointType::kFree, {0, 0, 0}, y);
  for (double side : {1.0, -1.0}) {
    const bool first = side > 0;
    add(first ? "b" : "e", "a", JointType::kRevolute, {0.2 * side, 0, 0}, z);
    add(first ? "c" : "f", first ? "b" : "e", JointType::kRevolute,
        {0, -0.4, 0}, x);
    add(first ? "d" : "g", first ? "c" : "f", JointType::kPrismatic,
        {0, -0.4, 0.1}, {0.6 * side, 0.8, 0});
  }
  return builder.Build().value();
}

TEST(MirrorTest, PairsByTheRestPoseAndMirrorsHingesAndSliders) {
  const auto skeleton = Legs();
  const MirrorMap map = FindMirrorMap(*skeleton).value();
  EXPECT_FALSE(map.by_names);
  EXPECT_EQ(map.partner, (std::vector<int>{0, 4, 5, 6, 1, 2, 3}));
  EXPECT_THAT(map.skewed, IsEmpty());
  Random random(2);
  const Eigen::VectorXd pose = RandomPose(random, *skeleton);
  Eigen::VectorXd mirrored = pose, twice = pose;
  MirrorPose(*skeleton, map, pose, mirrored);
  MirrorPose(*skeleton, map, mirrored, twice);
  Eigen::VectorXd change(skeleton->velocity_count());
  Difference(*skeleton, pose, twice, change);
  EXPECT_LT(change.cwiseAbs().maxCoeff(), kRounding);
  WorldTransforms frames, images;
  ForwardKinematics(*skeleton, pose, frames);
  ForwardKinematics(*skeleton, mirrored, images);
  for (int i = 0; i < skeleton->joint_count(); ++i) {
    Eigen::Vector3d image = frames[i].translation;
    image.x() = -image.x();
    EXPECT_LT((images[map.partner[i]].translation - image).norm(), kRounding);
  }
}

TEST(MirrorTest, SaysWhereItCannotTellSides) {
  Joint joint;
  joint.id = "only";
  joint.type = JointType::kSpherical;
  const auto skeleton = SkeletonBuilder().AddJoint(joint).Build().value();
  EXPECT_THAT(FindMirrorMap(*skeleton).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "left from right"));
  EXPECT_THAT(MirrorClip(Walk(), MirrorMap{.partner = {0}}).status(),
              Fails(kBad, "map: want 17 joints, got 1"));
}

TEST(ClipCutTest, CropsExactly) {
  const MotionClip walk = Walk();
  const MotionClip part = CropClip(walk, 0.215, 0.905).value();
  EXPECT_NEAR(part.duration_s(), 0.69, 1e-15);
  for (double time_s : {0.0, 0.1, 0.345, 0.69}) {
    Eigen::VectorXd change(walk.skeleton()->velocity_count());
    Difference(*walk.skeleton(), At(walk, 0.215 + time_s), At(part, time_s),
               change);
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-12) << time_s;
  }
  EXPECT_THAT(CropClip(walk, -0.1, 1).status(), Fails(kBad, "start_s"));
  EXPECT_THAT(CropClip(walk, 0.5, 0.5).status(), Fails(kBad, "end_s"));
  EXPECT_THAT(CropClip(walk, 0.5, 99).status(), Fails(kBad, "got 99"));
}

TEST(ClipCutTest, ResamplesThereAndBack) {
  const MotionClip walk = Walk();
  const double frame_s = walk.properties().frame_time_s;
  const MotionClip fine = ResampleClip(walk, frame_s / 4).value();
  EXPECT_EQ(fine.track(0).key_count(), 4 * 59 + 1);
  const MotionClip back = ResampleClip(fine, frame_s).value();
  for (int i = 0; i < 60; ++i) {
    EXPECT_LT(Apart(walk, back, i * frame_s), kRounding);
  }
  EXPECT_FALSE(ResampleClip(walk, -1).ok());
}

TEST(ClipCutTest, WarpsTime) {
  const MotionClip walk = Walk();
  const MotionClip same =
      WarpClip(walk, {{0, 0}, {walk.duration_s(), walk.duration_s()}}).value();
  const MotionClip slow =
      WarpClip(walk, {{0, 0.2}, {1, 0.4}, {2, 1.0}}).value();
  for (double time_s : {0.0, 0.4, 0.9}) {
    EXPECT_LT(Apart(walk, same, time_s), kRounding);
  }
  EXPECT_NEAR(slow.duration_s(), 2, 1e-12);
  Eigen::VectorXd change(walk.skeleton()->velocity_count());
  Difference(*walk.skeleton(), At(slow, 1.5), At(walk, 0.7), change);
  // Between frames of the warped clip there are straight lines.
  EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_THAT(WarpClip(walk, {{0, 0}}).status(), Fails(kBad, "keys"));
  EXPECT_THAT(WarpClip(walk, {{0, 0.5}, {1, 0.5}}).status(),
              Fails(kBad, "keys[1].clip_time_s"));
  EXPECT_THAT(WarpClip(walk, {{0.1, 0}, {0, 1}}).status(),
              Fails(kBad, "keys[0].time_s"));
}

}  // namespace
}  // namespace gelenk
