#include "gelenk/motion/gait_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/layer_stack.h"
#include "gelenk/motion/mirror.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::WalkingBvh;

MotionClip Walk(const std::string& bvh = WalkingBvh(200)) {
  const BvhDocument document = ReadBvh(bvh).value();
  return ClipFromBvh(document, ImportBvh(document).value(), "walk").value();
}

// `bvh` with a joint that never moves in the place of the parent of `joint`,
// between the two.
std::string WithJointOfNoLength(std::string bvh, const std::string& joint) {
  const size_t begin = bvh.find("JOINT " + joint + "\n");
  size_t end = bvh.find('{', begin);
  for (int depth = 1; depth > 0;) {
    end = bvh.find_first_of("{}", end + 1);
    depth += bvh[end] == '{' ? 1 : -1;
  }
  bvh.insert(end + 1, "\n}");
  bvh.insert(begin, "JOINT " + joint + "Base\n{\nOFFSET 0 0 0\nCHANNELS 0\n");
  return bvh;
}

double MeanStride(const GaitPhase& phase) {
  double sum = 0;
  for (double stride_m : phase.strides_m) sum += stride_m;
  return sum / static_cast<double>(phase.strides_m.size());
}

double MeanStep(const GaitPhase& phase) {
  return (phase.strikes_s.back() - phase.strikes_s.front()) /
         static_cast<double>(phase.strikes_s.size() - 1);
}

TEST(FindGaitPhaseTest, LegsMayBeginInThePlaceOfThePelvis) {
  const GaitPhase want = FindGaitPhase(Walk()).value();
  const auto got = FindGaitPhase(Walk(WithJointOfNoLength(
      WithJointOfNoLength(WalkingBvh(200), "LeftUpLeg"), "RightUpLeg")));
  ASSERT_TRUE(got.ok()) << got.status();
  EXPECT_EQ(got->strikes_s, want.strikes_s);
}

TEST(FindGaitPhaseTest, OneFootMayNotHangFromTheOther) {
  SkeletonBuilder builder;
  std::string parent;
  for (const char* id : {"Hips", "LeftUpLeg", "LeftLeg", "LeftFoot",
                         "RightUpLeg", "RightLeg", "RightFoot"}) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent;
    joint.type = parent.empty() ? JointType::kFree : JointType::kSpherical;
    joint.parent_from_joint.translation.y() = parent.empty() ? 0 : -0.4;
    parent = joint.id;
    builder.AddJoint(std::move(joint));
  }
  const auto skeleton = builder.Build().value();
  const Eigen::MatrixXd frames = skeleton->rest_positions().replicate(1, 30);
  const auto clip = ClipFromFrames(skeleton, frames, {.frame_time_s = 0.02});
  ASSERT_TRUE(clip.ok()) << clip.status();
  EXPECT_EQ(FindGaitPhase(*clip).status().code(),
            absl::StatusCode::kFailedPrecondition);
}

// The walk twice as fast, half a cycle later, turned and moved aside.
MotionClip FastWalk(const MotionClip& walk) {
  const GaitPhase phase = FindGaitPhase(walk).value();
  const double start_s = phase.strikes_s[1] - 0.2;
  const double end_s = walk.duration_s();
  const MotionClip fast =
      WarpClip(walk, {{0, start_s}, {0.5 * (end_s - start_s), end_s}}).value();
  Eigen::MatrixXd frames = FramesFromClip(fast).value();
  const RigidTransform aside = {ExpRotation({0, 2, 0}), {5, 0, -3}};
  for (Eigen::Index i = 0; i < frames.cols(); ++i) {
    const RigidTransform moved =
        aside * JointMotion(*walk.skeleton(), 0, frames.col(i));
    frames.col(i).head<3>() = moved.translation;
    StoreXyzw(moved.rotation, frames.col(i).data() + 3);
  }
  return ClipFromFrames(walk.skeleton(), frames,
                        {.frame_time_s = fast.properties().frame_time_s})
      .value();
}

TEST(GaitPhaseTest, FeetStrikeInTurnAndEvenly) {
  const GaitPhase phase = FindGaitPhase(Walk()).value();
  ASSERT_GE(phase.strikes_s.size(), 4);
  const double step_s = MeanStep(phase);
  for (size_t i = 1; i < phase.strikes_s.size(); ++i) {
    EXPECT_NEAR(phase.strikes_s[i] - phase.strikes_s[i - 1], step_s,
                0.1 * step_s);
  }
  EXPECT_GT(MeanStride(phase), 0.1);
}

TEST(GaitPhaseTest, TheMirrorSwapsTheFeet) {
  const MotionClip walk = Walk();
  const GaitPhase phase = FindGaitPhase(walk).value();
  const MirrorMap map = FindMirrorMap(*walk.skeleton()).value();
  const GaitPhase mirrored =
      FindGaitPhase(MirrorClip(walk, map).value()).value();
  ASSERT_EQ(mirrored.strikes_s.size(), phase.strikes_s.size());
  EXPECT_NE(mirrored.first_is_left, phase.first_is_left);
  for (size_t i = 0; i < phase.strikes_s.size(); ++i) {
    EXPECT_NEAR(mirrored.strikes_s[i], phase.strikes_s[i], 1e-6);
  }
}

TEST(GaitPhaseTest, AlignedStrikesComeTogether) {
  const MotionClip walk = Walk();
  const MotionClip run = FastWalk(walk);
  const GaitPhase walk_phase = FindGaitPhase(walk).value();
  const GaitPhase run_phase = FindGaitPhase(run).value();
  EXPECT_NEAR(MeanStep(run_phase), 0.5 * MeanStep(walk_phase), 0.02);
  const std::vector<WarpKey> keys = AlignStrikes(walk_phase, run_phase);
  ASSERT_GE(keys.size(), 3);
  const GaitPhase aligned = FindGaitPhase(WarpClip(run, keys).value()).value();
  EXPECT_NEAR(MeanStep(aligned), MeanStep(walk_phase), 0.03);
}

TEST(GaitPhaseTest, AWalkWithItselfIsTheWalk) {
  const MotionClip walk = Walk();
  const GaitPhase phase = FindGaitPhase(walk).value();
  const MotionClip blend = BlendGaits(walk, walk, 0.3).value();
  Sampler of_walk(walk), of_blend(blend);
  Eigen::VectorXd a = walk.skeleton()->rest_positions(), b = a;
  Eigen::VectorXd change(walk.skeleton()->velocity_count());
  for (int i = 0; i < 30; ++i) {
    const double time_s = i * blend.properties().frame_time_s;
    of_blend.Sample(time_s, a);
    of_walk.Sample(phase.strikes_s[0] + time_s, b);
    Difference(*walk.skeleton(), a, b, change);
    EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Blended as they lie feet cancel each other; blended by phase they do not.
TEST(GaitPhaseTest, WalkAndRunBlendWithoutCrossingFeet) {
  const MotionClip walk = Walk();
  const MotionClip run = FastWalk(walk);
  const GaitPhase walk_phase = FindGaitPhase(walk).value();
  const GaitPhase run_phase = FindGaitPhase(run).value();
  for (double part : {0.25, 0.5, 0.75}) {
    const MotionClip blend = BlendGaits(walk, run, part).value();
    const GaitPhase phase = FindGaitPhase(blend).value();
    EXPECT_GT(MeanStride(phase), 0.9 * MeanStride(walk_phase)) << part;
    EXPECT_NEAR(MeanStep(phase),
                (1 - part) * MeanStep(walk_phase) + part * MeanStep(run_phase),
                0.05)
        << part;
    // The same way, at the same height: the run was moved onto the walk.
    Sampler sampler(blend);
    Eigen::VectorXd pose = walk.skeleton()->rest_positions();
    sampler.Sample(blend.duration_s(), pose);
    EXPECT_LT(std::abs(pose[0]), 0.1);
    EXPECT_GT(pose[2], 0.5);
  }
}

TEST(GaitPhaseTest, SaysWhereThereIsNoGait) {
  constexpr absl::StatusCode kNot = absl::StatusCode::kFailedPrecondition;
  const MotionClip walk = Walk();
  const MotionClip still = MotionClip::Create(walk.skeleton(), {}).value();
  EXPECT_THAT(FindGaitPhase(still).status(), Fails(kNot, "strikes"));
  testing::Random random(1);
  testing::SkeletonRecipe recipe;
  recipe.branching = 0;
  const MotionClip rope =
      MotionClip::Create(testing::RandomSkeleton(random, recipe), {}).value();
  EXPECT_THAT(FindGaitPhase(rope).status(), Fails(kNot, "foot"));
  EXPECT_THAT(BlendGaits(walk, rope, 0.5).status(),
              Fails(absl::StatusCode::kInvalidArgument, "another skeleton"));
  EXPECT_THAT(BlendGaits(walk, walk, 1.5).status(),
              Fails(absl::StatusCode::kInvalidArgument, "part"));
}

}  // namespace
}  // namespace gelenk
