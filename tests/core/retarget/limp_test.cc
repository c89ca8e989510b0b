// A limp, laid on a walk, is still a limp when feet are locked and when another
// body walks.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "gelenk/formats/bvh_clip.h"
#include "gelenk/formats/bvh_reader.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/difference_clip.h"
#include "gelenk/motion/layer_stack.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/moving_body.h"
#include "gelenk/retarget/plant_feet.h"
#include "tests/testing/body_clips.h"
#include "tests/testing/rig_family.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

// The stride of one side may change against the other's by so much.
constexpr double kTolerance = 0.1;

MotionClip Walk() {
  const BvhDocument document = ReadBvh(testing::WalkingBvh(300)).value();
  return ClipFromBvh(document, ImportBvh(document).value()).value();
}

// The clip with thighs that swing by so much of what they did.
MotionClip WithStrides(const MotionClip& clip, double left, double right) {
  Eigen::MatrixXd frames = FramesFromClip(clip).value();
  const Skeleton& skeleton = *clip.skeleton();
  const auto scale = [&](const char* thigh, double part) {
    const int row = skeleton.span(skeleton.FindJoint(thigh)).quaternion_offset;
    for (Eigen::Index f = 0; f < frames.cols(); ++f) {
      double* numbers = frames.col(f).data() + row;
      StoreXyzw(
          Eigen::Quaterniond::Identity().slerp(part, QuaternionXyzw(numbers)),
          numbers);
    }
  };
  scale("LeftUpLeg", left);
  scale("RightUpLeg", right);
  return ClipFromFrames(clip.skeleton(), frames, clip.properties()).value();
}

// What a limp does to a walk, laid on another one with shorter strides.
MotionClip LimpLaidOnAnotherWalk() {
  const MotionClip walk = Walk();
  const MotionClip limp =
      DifferenceClip(WithStrides(walk, 0.6, 1), walk).value();
  const MotionClip base = WithStrides(walk, 0.85, 0.85);
  std::vector<ClipLayer> layers = {
      {.clip = base}, {.clip = limp, .kind = ClipLayer::Kind::kAdditive}};
  ClipProperties properties = base.properties();
  properties.frame_time_s = FrameTimeOf(base);
  return ClipFromLayers(
             LayerStack::Create(walk.skeleton(), std::move(layers)).value(),
             walk.skeleton(), walk.duration_s(), std::move(properties))
      .value();
}

MovingBody BodyOf(const MotionClip& clip) {
  return MakeMovingBody(clip.skeleton(), FramesFromClip(clip).value(),
                        FrameTimeOf(clip))
      .value();
}

std::shared_ptr<const BodyModel> ModelOf(
    const std::shared_ptr<const Skeleton>& skeleton) {
  return MakeBodyModel(skeleton, ProposeJointMap(*skeleton).value()).value();
}

// The strides of the sides, left over right: how far a foot goes beside the
// hips, from its hindmost to its foremost.
double StrideAsymmetry(const BodyModel& model,
                       const Eigen::MatrixXd& positions) {
  std::array<double, 2> foremost = {-1, -1};
  std::array<double, 2> hindmost = {1, 1};
  for (const BodyPose& pose : testing::BodyPosesOf(model, positions)) {
    const Eigen::Quaterniond& pelvis = pose.rotation(BodyRole::kPelvis);
    for (int side : kSides) {
      const Eigen::Vector3d way =
          pose.position(kLegRoles[side].foot) - pose.hip_center;
      const double forwards = (pelvis.conjugate() * way).z();
      foremost[side] = std::max(foremost[side], forwards);
      hindmost[side] = std::min(hindmost[side], forwards);
    }
  }
  return (foremost[kLeft] - hindmost[kLeft]) /
         (foremost[kRight] - hindmost[kRight]);
}

TEST(LimpTest, AnAdditiveLayerSurvivesFootLockAndRetargeting) {
  const MotionClip limping = LimpLaidOnAnotherWalk();
  const MovingBody source = BodyOf(limping);
  const double wanted = StrideAsymmetry(*source.model, source.positions);
  ASSERT_LT(wanted, 0.7) << "a limp";

  const absl::StatusOr<PlantedClip> planted = PlantFeet(limping);
  ASSERT_TRUE(planted.ok()) << planted.status();
  const MovingBody locked = BodyOf(planted->clip);
  EXPECT_NEAR(StrideAsymmetry(*locked.model, locked.positions) / wanted, 1,
              kTolerance);
  // Feet were locked on the way.
  const auto before = MeasureBody(source, nullptr);
  const auto after = MeasureBody(locked, &source);
  ASSERT_TRUE(before.ok() && after.ok());
  EXPECT_GT(before->quality.skate.contact_ratio, 0.05);
  EXPECT_LT(after->comparison->label_skate_ratio, 0.1);

  for (const auto& target :
       {ModelOf(MakeHumanoid()),
        ModelOf(testing::BodyOf(testing::RigFamilies()[1]))}) {
    for (const LookAhead look_ahead :
         {LookAhead::kNone, LookAhead::kWholeClip}) {
      for (const MovingBody* from : {&source, &locked}) {
        const auto positions = RetargetBody(*from, target, look_ahead, {});
        ASSERT_TRUE(positions.ok()) << positions.status();
        EXPECT_NEAR(StrideAsymmetry(*target, *positions) / wanted, 1,
                    kTolerance)
            << (look_ahead == LookAhead::kNone ? "online" : "offline")
            << (from == &locked ? ", feet locked before" : "");
      }
    }
  }
}

}  // namespace
}  // namespace gelenk
