#include "gelenk/motion/keyframe_edit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/sampler.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomRotation;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;
constexpr PosePartKind kTurn = PosePartKind::kRotation;

// A free hip, a thigh and a shin of balls, a toe of a hinge.
std::shared_ptr<const Skeleton> Leg() {
  SkeletonBuilder builder;
  const char* parent = "";
  for (const char* id : {"hip", "thigh", "shin", "toe"}) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent;
    joint.type = parent[0] == '\0'          ? JointType::kFree
                 : std::string("toe") == id ? JointType::kRevolute
                                            : JointType::kSpherical;
    joint.parent_from_joint.translation = {0, -0.4, 0.1};
    joint.parent_from_joint.rotation = ExpRotation({0.1, 0.2, -0.3});
    builder.AddJoint(joint);
    parent = id;
  }
  return builder.Build().value();
}

MotionClip Posed(Random& random, Interpolation interpolation) {
  MotionClip clip = MotionClip::Create(Leg(), {}).value();
  for (double time_s : {0.0, 0.5, 1.0}) {
    clip = CapturePose(clip, time_s, RandomPose(random, *clip.skeleton()), {},
                       interpolation)
               .value();
  }
  return clip;
}

Eigen::VectorXd At(const MotionClip& clip, double time_s) {
  Eigen::VectorXd positions(clip.skeleton()->position_count());
  Sampler(clip).Sample(time_s, positions);
  return positions;
}

double Apart(const MotionClip& clip, const Eigen::VectorXd& a,
             const Eigen::VectorXd& b) {
  Eigen::VectorXd change(clip.skeleton()->velocity_count());
  Difference(*clip.skeleton(), a, b, change);
  return change.cwiseAbs().maxCoeff();
}

std::vector<double> Xyzw(const Eigen::Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};
}

TEST(KeyframeEditTest, CapturedPosesAreMetInAnyOrder) {
  Random random(1);
  for (Interpolation interpolation :
       {Interpolation::kStep, Interpolation::kLinear,
        Interpolation::kCatmullRom}) {
    MotionClip clip = MotionClip::Create(Leg(), {}).value();
    const double times_s[] = {1, 0, 0.25, 3, 2};
    std::vector<Eigen::VectorXd> poses;
    for (double time_s : times_s) {
      poses.push_back(RandomPose(random, *clip.skeleton()));
      clip = CapturePose(clip, time_s, poses.back(), {}, interpolation).value();
    }
    for (int i = 0; i < 5; ++i) {
      EXPECT_LT(Apart(clip, At(clip, times_s[i]), poses[i]), 1e-14);
    }
    // Again at the same time: replaced.
    clip = CapturePose(clip, 1 + 1e-7, poses[1]).value();
    EXPECT_EQ(clip.track(0).key_count(), 5);
    EXPECT_LT(Apart(clip, At(clip, 1), poses[1]), 1e-14);
  }
}

TEST(KeyframeEditTest, CapturesChosenJointsOnly) {
  Random random(2);
  const MotionClip clip = MotionClip::Create(Leg(), {}).value();
  const Eigen::VectorXd pose = RandomPose(random, *clip.skeleton());
  const std::vector<int> joints = {2};
  const MotionClip shin = CapturePose(clip, 1, pose, joints).value();
  ASSERT_EQ(shin.track_count(), 1);
  EXPECT_EQ(shin.track(0).joint, 2);
  const std::vector<int> none = {4};
  EXPECT_THAT(CapturePose(clip, 1, pose, none).status(), Fails(kBad, "got 4"));
  EXPECT_THAT(CapturePose(clip, -1, pose).status(), Fails(kBad, "time_s"));
  EXPECT_THAT(CapturePose(clip, 1, Eigen::VectorXd::Zero(3)).status(),
              Fails(kBad, "positions"));
}

TEST(KeyframeEditTest, InsertsMovesAndDeletes) {
  Random random(3);
  const MotionClip clip = Posed(random, Interpolation::kLinear);
  const std::vector<double> value = Xyzw(RandomRotation(random));
  const MotionClip more = InsertKey(clip, 1, kTurn, 0.7, value).value();
  const int track = more.FindTrack(1, kTurn);
  EXPECT_EQ(more.track(track).times_s, (std::vector<double>{0, 0.5, 0.7, 1}));
  EXPECT_LT(
      AngleBetween(QuaternionXyzw(At(more, 0.7).data() +
                                  more.curve(track).part().position_offset),
                   QuaternionXyzw(value.data())),
      1e-14);
  // The old revision is what it was.
  EXPECT_EQ(clip.track(clip.FindTrack(1, kTurn)).key_count(), 3);

  const MotionClip moved = MoveKey(more, 1, kTurn, 0.7, 1.4).value();
  EXPECT_EQ(moved.track(track).times_s, (std::vector<double>{0, 0.5, 1, 1.4}));
  EXPECT_EQ(moved.duration_s(), 1.4);
  EXPECT_THAT(MoveKey(more, 1, kTurn, 0.7, 0.5).status(),
              Fails(kBad, "a key at 0.5 s already"));
  EXPECT_THAT(MoveKey(more, 1, kTurn, 0.6, 2).status(),
              Fails(kBad, "no key at 0.6"));

  const MotionClip less = DeleteKey(more, 1, kTurn, 0.7).value();
  for (double time_s : {0.0, 0.3, 0.8, 1.0}) {
    EXPECT_LT(Apart(clip, At(clip, time_s), At(less, time_s)), 1e-14);
  }
  EXPECT_THAT(DeleteKey(less, 1, kTurn, 0.7).status(), Fails(kBad, "no key"));
}

TEST(KeyframeEditTest, WithItsLastKeyATrackGoes) {
  const MotionClip clip = MotionClip::Create(Leg(), {}).value();
  const std::vector<double> angle = {0.3};
  const MotionClip toe =
      InsertKey(clip, 3, PosePartKind::kNumbers, 2, angle).value();
  EXPECT_EQ(toe.duration_s(), 2);
  const MotionClip none = DeleteKey(toe, 3, PosePartKind::kNumbers, 2).value();
  EXPECT_EQ(none.track_count(), 0);
  EXPECT_EQ(At(none, 2), clip.properties().base_positions);
}

TEST(KeyframeEditTest, CubicSplinesKeepTheirTangentsInStep) {
  JointTrack track{.joint = 3,
                   .kind = PosePartKind::kNumbers,
                   .interpolation = Interpolation::kCubicSpline,
                   .times_s = {0, 1, 2}};
  track.values = Eigen::RowVector3d(0, 1, 0);
  track.in_tangents = track.out_tangents = Eigen::RowVector3d(5, 6, 7);
  const MotionClip clip = MotionClip::Create(Leg(), {track}).value();
  const std::vector<double> value = {0.5};
  const MotionClip more =
      InsertKey(clip, 3, PosePartKind::kNumbers, 1.5, value).value();
  Eigen::RowVector4d expected(5, 6, -1, 7);  // (0 - 1) / (2 - 1)
  EXPECT_EQ(more.track(0).in_tangents, expected);
  const MotionClip moved =
      MoveKey(more, 3, PosePartKind::kNumbers, 0, 1.7).value();
  expected << 6, -1, 5, 7;
  EXPECT_EQ(moved.track(0).out_tangents, expected);
  EXPECT_EQ(
      DeleteKey(moved, 3, PosePartKind::kNumbers, 1)->track(0).key_count(), 3);
}

// Top-down: the hip is changed, the leg below stays where it was turned.
TEST(KeyframeEditTest, CounterAnimationKeepsTheChildrenInTheWorld) {
  Random random(4);
  const MotionClip clip = Posed(random, Interpolation::kCatmullRom);
  const Skeleton& skeleton = *clip.skeleton();
  const std::vector<double> turn = Xyzw(RandomRotation(random));
  const MotionClip follow = InsertKey(clip, 0, kTurn, 0.5, turn).value();
  const MotionClip keep =
      InsertKey(clip, 0, kTurn, 0.5, turn, ChildrenOnEdit::kKeepWorld).value();
  WorldTransforms before, followed, kept;
  ForwardKinematics(skeleton, At(clip, 0.5), before);
  ForwardKinematics(skeleton, At(follow, 0.5), followed);
  ForwardKinematics(skeleton, At(keep, 0.5), kept);
  for (int joint : {1, 2, 3}) {
    EXPECT_GT(AngleBetween(before[joint].rotation, followed[joint].rotation),
              0.1);
    EXPECT_LT(AngleBetween(before[joint].rotation, kept[joint].rotation),
              1e-12);
  }
  EXPECT_LT(AngleBetween(kept[0].rotation, followed[0].rotation), 1e-12);
  // Local angles of what followed are as they were.
  EXPECT_EQ(At(follow, 0.5).tail(9), At(clip, 0.5).tail(9));
}

TEST(KeyframeEditTest, RefusesWhatDoesNotFit) {
  const MotionClip clip = MotionClip::Create(Leg(), {}).value();
  const std::vector<double> one = {1}, bad = {0, 0, 0, 2}, nan = {NAN};
  const PosePartKind numbers = PosePartKind::kNumbers;
  EXPECT_THAT(InsertKey(clip, 1, numbers, 0, one).status(),
              Fails(kBad, "\"thigh\" has no numbers"));
  EXPECT_THAT(InsertKey(clip, 9, numbers, 0, one).status(),
              Fails(kBad, "joint: want 0 to 3, got 9"));
  EXPECT_THAT(InsertKey(clip, 1, kTurn, 0, one).status(),
              Fails(kBad, "want 4 numbers, got 1"));
  EXPECT_THAT(InsertKey(clip, 1, kTurn, 0, bad).status(),
              Fails(kBad, "unit quaternion"));
  EXPECT_THAT(InsertKey(clip, 3, numbers, 0, nan).status(),
              Fails(kBad, "got nan"));
  EXPECT_THAT(InsertKey(clip, 3, numbers, INFINITY, one).status(),
              Fails(kBad, "time_s"));
  EXPECT_THAT(MoveKey(clip, 3, numbers, 0, -1).status(), Fails(kBad, "to_s"));
}

MotionClip Named(const char* name) {
  return MotionClip::Create(Leg(), {}, {.name = name}).value();
}

TEST(RevisionHistoryTest, UndoesRedoesAndForgetsTheOldest) {
  RevisionHistory history(Named("a"), 3);
  EXPECT_FALSE(history.Undo());
  EXPECT_EQ(history.Commit(Named("b")), 2);
  EXPECT_EQ(history.Commit(Named("c")), 3);
  EXPECT_FALSE(history.Redo());
  EXPECT_TRUE(history.Undo());
  EXPECT_EQ(history.current().name(), "b");
  EXPECT_TRUE(history.Redo());
  EXPECT_EQ(history.current().name(), "c");
  history.Undo();
  EXPECT_EQ(history.Commit(Named("d")), 4);
  EXPECT_THAT(history.At(3).status(),
              Fails(absl::StatusCode::kNotFound, "those kept are 1 to 4"));
  history.Commit(Named("e"));
  EXPECT_FALSE(history.At(1).ok());
  EXPECT_EQ(history.At(2)->name(), "b");
  EXPECT_EQ(history.revision(), 5);
  const RevisionHistory copy = history;
  history.Undo();
  EXPECT_EQ(copy.current().name(), "e");
}

}  // namespace
}  // namespace gelenk
