#include "gelenk/motion/layer_stack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "gelenk/math/rotation.h"
#include "gelenk/motion/blender.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/difference_clip.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::gelenk::testing::AllocationCount;
using ::gelenk::testing::Fails;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVelocity;
using SkeletonPtr = std::shared_ptr<const Skeleton>;

constexpr absl::StatusCode kBad = absl::StatusCode::kInvalidArgument;
constexpr double kFrame_s = 0.02;
// A few products of unit quaternions.
constexpr double kRounding = 1e-12;

// Moves by up to a fifth of a rad or m a frame.
MotionClip RandomClip(Random& random, const SkeletonPtr& skeleton,
                      int count = 20) {
  Eigen::MatrixXd frames(skeleton->position_count(), count);
  frames.col(0) = RandomPose(random, *skeleton);
  for (int i = 1; i < count; ++i) {
    Integrate(*skeleton, frames.col(i - 1),
              RandomVelocity(random, *skeleton, 0.2), frames.col(i));
  }
  return ClipFromFrames(skeleton, frames, {.frame_time_s = kFrame_s}).value();
}

Eigen::VectorXd At(const MotionClip& clip, double time_s) {
  Eigen::VectorXd positions(clip.skeleton()->position_count());
  Sampler(clip).Sample(time_s, positions);
  return positions;
}

Eigen::VectorXd At(LayerStack& stack, const SkeletonPtr& skeleton,
                   double time_s) {
  Eigen::VectorXd positions(skeleton->position_count());
  stack.Sample(time_s, positions);
  return positions;
}

double Apart(const Skeleton& skeleton, const Eigen::VectorXd& a,
             const Eigen::VectorXd& b) {
  Eigen::VectorXd change(skeleton.velocity_count());
  Difference(skeleton, a, b, change);
  return change.size() > 0 ? change.cwiseAbs().maxCoeff() : 0;
}

TEST(BlenderTest, EqualPosesComeOutAsTheyWentIn) {
  Random random(1);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const Eigen::VectorXd pose = RandomPose(random, *skeleton);
  Eigen::VectorXd out = skeleton->rest_positions();
  const BlendInput one{.positions = pose.data(), .weight = 0.3};
  const BlendInput other{.positions = pose.data(), .weight = 5};
  Blender(skeleton).Blend({one, other, one}, out);
  EXPECT_LT(Apart(*skeleton, pose, out), 1e-14);
}

TEST(BlenderTest, TwoPosesMeetOnTheWayBetweenThem) {
  Random random(2);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const Eigen::VectorXd a = RandomPose(random, *skeleton);
  const Eigen::VectorXd b = RandomPose(random, *skeleton);
  Eigen::VectorXd way(skeleton->velocity_count()), expected = a, out = a;
  Difference(*skeleton, a, b, way);
  Integrate(*skeleton, a, 0.25 * way, expected);
  Blender(skeleton).Blend({{.positions = a.data(), .weight = 3},
                           {.positions = b.data(), .weight = 1}},
                          out);
  EXPECT_LT(Apart(*skeleton, expected, out), kRounding);
}

TEST(BlenderTest, OrderDoesNotMatterAndTheTurnsToTheMeanCancel) {
  Random random(3);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const Eigen::VectorXd center = RandomPose(random, *skeleton);
  std::vector<Eigen::VectorXd> poses;
  std::vector<BlendInput> inputs;
  for (int i = 0; i < 4; ++i) {
    poses.push_back(center);
    Integrate(*skeleton, center, RandomVelocity(random, *skeleton, 0.8),
              poses.back());
  }
  for (int i = 0; i < 4; ++i) {
    inputs.push_back({.positions = poses[i].data(), .weight = 1.0 + i});
  }
  const Blender blender(skeleton);
  Eigen::VectorXd mean = center, again = center;
  blender.Blend(inputs, mean);
  std::swap(inputs[0], inputs[3]);
  blender.Blend(inputs, again);
  EXPECT_LT(Apart(*skeleton, mean, again), kRounding);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(skeleton->velocity_count());
  Eigen::VectorXd change = sum;
  for (int i = 0; i < 4; ++i) {
    Difference(*skeleton, mean, poses[i], change);
    sum += (1.0 + i) * change;
  }
  EXPECT_LT(sum.cwiseAbs().maxCoeff(), 1e-11);
}

TEST(BlenderTest, MasksChooseJointsAndNoWeightLeavesAlone) {
  Random random(4);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const Eigen::VectorXd a = RandomPose(random, *skeleton);
  const Eigen::VectorXd start = RandomPose(random, *skeleton);
  std::vector<double> mask(skeleton->joint_count(), 0);
  mask[1] = 1;
  Eigen::VectorXd out = start;
  Blender(skeleton).Blend({{.positions = a.data(), .joint_weights = mask}},
                          out);
  for (const PosePart& part : PosePartsOf(*skeleton)) {
    const Eigen::VectorXd& from = part.joint == 1 ? a : start;
    EXPECT_EQ(out.segment(part.position_offset, part.position_count),
              from.segment(part.position_offset, part.position_count));
  }
}

TEST(LayerStackTest, OneLayerIsTheClip) {
  Random random(5);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip clip = RandomClip(random, skeleton);
  LayerStack stack =
      LayerStack::Create(skeleton, {{.clip = clip, .start_s = 1, .speed = 2}})
          .value();
  EXPECT_EQ(At(stack, skeleton, 1.1), At(clip, 2 * (1.1 - 1)));
  EXPECT_NEAR(stack.end_s(), 1 + clip.duration_s() / 2, 1e-15);
  LayerStack empty = LayerStack::Create(skeleton, {}).value();
  EXPECT_EQ(At(empty, skeleton, 0), skeleton->rest_positions());
}

TEST(LayerStackTest, ALayerOfTheSameClipChangesNothing) {
  Random random(6);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip clip = RandomClip(random, skeleton);
  LayerStack stack =
      LayerStack::Create(skeleton, {{.clip = clip},
                                    {.clip = clip, .weight = 0.4},
                                    {.clip = clip, .weight = 0.9}})
          .value();
  for (double time_s : {0.0, 0.013, 0.2, 9.0}) {
    EXPECT_LT(Apart(*skeleton, At(stack, skeleton, time_s), At(clip, time_s)),
              kRounding);
  }
}

TEST(LayerStackTest, MasksKeepTheRestOfTheBody) {
  Random random(7);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip walk = RandomClip(random, skeleton);
  const MotionClip wave = RandomClip(random, skeleton);
  const std::vector<double> mask = MaskBelow(*skeleton, 4);
  LayerStack stack =
      LayerStack::Create(
          skeleton, {{.clip = walk}, {.clip = wave, .joint_weights = mask}})
          .value();
  const Eigen::VectorXd pose = At(stack, skeleton, 0.1);
  for (const PosePart& part : PosePartsOf(*skeleton)) {
    const Eigen::VectorXd from = At(mask[part.joint] > 0 ? wave : walk, 0.1);
    EXPECT_EQ(pose.segment(part.position_offset, part.position_count),
              from.segment(part.position_offset, part.position_count));
  }
  EXPECT_EQ(mask[4], 1);
  EXPECT_EQ(mask[0], 0);
}

// The difference of two motions on top of one gives the other.
TEST(LayerStackTest, ADifferenceOnItsBaseIsTheClip) {
  Random random(8);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip walk = RandomClip(random, skeleton);
  const MotionClip limp = RandomClip(random, skeleton);
  const MotionClip difference = DifferenceClip(limp, walk).value();
  LayerStack stack =
      LayerStack::Create(
          skeleton, {{.clip = walk},
                     {.clip = difference, .kind = ClipLayer::Kind::kAdditive}})
          .value();
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT(Apart(*skeleton, At(stack, skeleton, i * kFrame_s),
                    At(limp, i * kFrame_s)),
              kRounding);
  }
}

TEST(LayerStackTest, AdditiveWeightsScaleAndUndo) {
  Random random(9);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip walk = RandomClip(random, skeleton);
  const Eigen::VectorXd base = At(walk, 0.1);
  const MotionClip lean =
      DifferenceClip(RandomClip(random, skeleton), base).value();
  LayerStack stack =
      LayerStack::Create(
          skeleton,
          {{.clip = walk},
           {.clip = lean, .kind = ClipLayer::Kind::kAdditive, .weight = 0.7},
           {.clip = lean, .kind = ClipLayer::Kind::kAdditive, .weight = -0.7}})
          .value();
  EXPECT_LT(Apart(*skeleton, At(stack, skeleton, 0.2), At(walk, 0.2)),
            kRounding);
}

TEST(LayerStackTest, CrossFadesFromOneToTheOther) {
  Random random(10);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip first = RandomClip(random, skeleton);
  const MotionClip second = RandomClip(random, skeleton);
  const MotionClip both = CrossFade(first, second, 0.2, 0.1).value();
  EXPECT_NEAR(both.duration_s(), 0.2 + second.duration_s(), 1e-12);
  EXPECT_LT(Apart(*skeleton, At(both, 0.18), At(first, 0.18)), kRounding);
  EXPECT_LT(Apart(*skeleton, At(both, 0.3), At(second, 0.1)), kRounding);
  EXPECT_GT(Apart(*skeleton, At(both, 0.26), At(second, 0.06)), 1e-3);
  // Equal clips: nothing to see of the fade.
  const MotionClip same = CrossFade(first, first, 0, 0.1).value();
  EXPECT_LT(Apart(*skeleton, At(same, 0.06), At(first, 0.06)), kRounding);
  EXPECT_THAT(CrossFade(first, second, -1, 0.1).status(),
              Fails(kBad, "start_s"));
  EXPECT_THAT(CrossFade(first, second, 1, NAN).status(), Fails(kBad, "fade_s"));
}

TEST(LayerStackTest, RefusesWhatDoesNotFitListingAll) {
  Random random(11);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const SkeletonPtr other = RandomSkeleton(random);
  const MotionClip clip = RandomClip(random, skeleton);
  const absl::Status status =
      LayerStack::Create(
          skeleton,
          {{.clip = RandomClip(random, other), .weight = 1.5},
           {.clip = clip, .weight = WeightCurve({{1, 0}, {0, 1}})},
           {.clip = clip,
            .joint_weights = std::vector<double>(skeleton->joint_count(), 2),
            .start_s = INFINITY,
            .speed = NAN},
           {.clip = clip, .joint_weights = {1}}})
          .status();
  for (const char* words :
       {"layers[0].clip: is of another", "layers[0].weight[0].weight: want at",
        "layers[1].weight[1].time_s", "layers[2].joint_weights[0]: want 0 to 1",
        "layers[2].start_s", "layers[2].speed"}) {
    EXPECT_THAT(status, Fails(kBad, words));
  }
  EXPECT_THAT(
      LayerStack::Create(skeleton, {{.clip = clip, .joint_weights = {1}}})
          .status(),
      Fails(kBad, "numbers or none, got 1"));
}

TEST(WeightCurveTest, RunsStraightBetweenKeys) {
  const WeightCurve curve({{1, 0}, {2, 1}, {2, 0.5}, {3, 0}});
  EXPECT_EQ(curve.At(-5), 0);
  EXPECT_EQ(curve.At(1.25), 0.25);
  EXPECT_EQ(curve.At(2), 0.5);
  EXPECT_EQ(curve.At(2.5), 0.25);
  EXPECT_EQ(curve.At(99), 0);
}

TEST(LayerStackTest, AllocatesNothing) {
  Random random(12);
  const SkeletonPtr skeleton = RandomSkeleton(random);
  const MotionClip clip = RandomClip(random, skeleton);
  LayerStack stack =
      LayerStack::Create(skeleton,
                         {{.clip = clip},
                          {.clip = clip,
                           .weight = WeightCurve::FadeIn(0.1, 0.2),
                           .joint_weights = MaskBelow(*skeleton, 2),
                           .mode = PlaybackMode::kLoop},
                          {.clip = clip, .kind = ClipLayer::Kind::kAdditive}})
          .value();
  Eigen::VectorXd pose(skeleton->position_count());
  const Blender blender(skeleton);
  const Eigen::VectorXd other = RandomPose(random, *skeleton);
  const int before = AllocationCount();
  for (int i = 0; i < 50; ++i) {
    stack.Sample(0.013 * i, pose);
    const BlendInput inputs[] = {{.positions = other.data()},
                                 {.positions = pose.data(), .weight = 2}};
    blender.Blend(inputs, pose);
  }
  EXPECT_EQ(AllocationCount() - before, 0);
}

}  // namespace
}  // namespace gelenk
