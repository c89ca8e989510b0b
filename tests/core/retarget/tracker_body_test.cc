#include "gelenk/retarget/tracker_body.h"

#include <gtest/gtest.h>

#include <limits>

#include "gelenk/math/rotation.h"
#include "gelenk/retarget/retargeter.h"
#include "tests/testing/rig_family.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/tracked_actor.h"

namespace gelenk {
namespace {

using testing::Actor;
using testing::TrackersOn;
using testing::WalkingActor;

constexpr double kFrameTime = 0.02;

double DistanceBetween(const TrackerFrame& a, const TrackerFrame& b,
                       bool with_lower) {
  const auto distance = [](const auto& x, const auto& y) {
    return (x->translation - y->translation).norm();
  };
  double worst = distance(a.head, b.head);
  for (int side : kSides) {
    worst = std::max(worst, distance(a.hands[side], b.hands[side]));
    if (with_lower) {
      worst = std::max(worst, distance(a.feet[side], b.feet[side]));
    }
  }
  if (with_lower) worst = std::max(worst, distance(a.waist, b.waist));
  return worst;
}

TEST(TrackerBodyTest, SixTrackersHoldHeadHandsWaistAndFeet) {
  const Actor actor = WalkingActor(150);
  const auto body = TrackerBody::Create();
  ASSERT_TRUE(body.ok());
  for (int f = 0; f < actor.positions.cols(); ++f) {
    const TrackerFrame frame =
        TrackersOn(*actor.model, actor.positions.col(f), true);
    ASSERT_TRUE((*body)->Update(frame, kFrameTime).ok());
    const TrackerFrame made =
        TrackersOn(*(*body)->model(), (*body)->positions(), true);
    // The posture pulls a little.
    ASSERT_LT(DistanceBetween(frame, made, true), 0.02) << f;
  }
}

TEST(TrackerBodyTest, ThreeTrackersMakeAWholeBodyThatStandsAndWalks) {
  const Actor actor = WalkingActor(150);
  const auto body = TrackerBody::Create();
  ASSERT_TRUE(body.ok());
  double way = 0;
  TrackerFrame last;
  for (int f = 0; f < actor.positions.cols(); ++f) {
    const TrackerFrame frame =
        TrackersOn(*actor.model, actor.positions.col(f), false);
    ASSERT_TRUE((*body)->Update(frame, kFrameTime).ok());
    const TrackerFrame made =
        TrackersOn(*(*body)->model(), (*body)->positions(), true);
    ASSERT_LT(DistanceBetween(frame, made, false), 0.03) << f;
    // Hips below the head, feet below the hips and above the ground.
    const Eigen::Vector3d hips = made.waist->translation;
    ASSERT_LT(Horizontal(hips - made.head->translation).norm(), 0.25) << f;
    for (int side : kSides) {
      const Eigen::Vector3d foot = made.feet[side]->translation;
      ASSERT_GT(foot.y(), 0.02) << f;
      ASSERT_LT(foot.y(), 0.35) << f;
      ASSERT_LT(Horizontal(foot - hips).norm(), 0.6) << f;
    }
    if (f > 0) {
      way = std::max(
          way, (made.feet[0]->translation - last.feet[0]->translation).norm());
    }
    last = made;
  }
  // No foot jumps: steps of a brisk walk, one after the other, peak at 6.4 m/s.
  EXPECT_LT(way, 8 * kFrameTime);
  EXPECT_EQ(
      LimitExcess(*(*body)->model()->skeleton, (*body)->positions(), nullptr),
      0);
}

TEST(TrackerBodyTest, ItsBodyIsASourceLikeAnyOther) {
  const Actor actor = WalkingActor(150);
  const auto skeleton = testing::BodyOf(testing::RigFamilies()[0]);
  const auto target = *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
  for (bool with_lower : {false, true}) {
    const auto body = TrackerBody::Create();
    ASSERT_TRUE(body.ok());
    auto retargeter = Retargeter::Create((*body)->model(), target);
    ASSERT_TRUE(retargeter.ok());
    BodyPoseReader reader(target);
    BodyPose pose;
    for (int f = 0; f < actor.positions.cols(); ++f) {
      ASSERT_TRUE((*body)
                      ->Update(TrackersOn(*actor.model, actor.positions.col(f),
                                          with_lower),
                               kFrameTime)
                      .ok());
      ASSERT_TRUE(
          (*retargeter)->Retarget((*body)->positions(), kFrameTime).ok());
      reader.Read((*retargeter)->positions(), pose);
      for (int side : kSides) {
        ASSERT_LT((*retargeter)->report().hand_error_m[side], 0.01) << f;
        for (int point = 0; point < kFootPointCount; ++point) {
          ASSERT_GT(pose.foot_points[side][point].y() -
                        target->planted_heights[side][point],
                    -1e-3)
              << f;
        }
      }
    }
    // It went where the actor went, by its own legs.
    const Eigen::Vector3d way =
        actor.positions.col(149).head<3>() - actor.positions.col(0).head<3>();
    EXPECT_NEAR(pose.hip_center.z(),
                way.z() * target->leg_length / actor.model->leg_length, 0.2);
  }
}

TEST(TrackerBodyTest, MountsAreLearnedFromATPose) {
  const auto skeleton = MakeHumanoid();
  const auto body = TrackerBody::Create();
  ASSERT_TRUE(body.ok());
  const TrackerFrame in_joints =
      TrackersOn(*(*body)->model(), skeleton->rest_positions(), false);
  const RigidTransform mount = {Eigen::Quaterniond(Eigen::AngleAxisd(
                                    1, Eigen::Vector3d(1, 2, 3) / 3.7417)),
                                Eigen::Vector3d(0.02, 0.05, -0.1)};
  TrackerFrame mounted = in_joints;
  mounted.head->rotation.normalize();
  mounted.head = *in_joints.head * mount;
  mounted.head->rotation.normalize();
  (*body)->Calibrate(mounted);
  ASSERT_TRUE((*body)->Update(mounted, kFrameTime).ok());
  const TrackerFrame made =
      TrackersOn(*(*body)->model(), (*body)->positions(), false);
  EXPECT_LT(DistanceBetween(in_joints, made, false), 0.03);
}

TEST(TrackerBodyTest, ALostHandIsHeldAndBadFramesChangeNothing) {
  const auto body = TrackerBody::Create();
  ASSERT_TRUE(body.ok());
  TrackerFrame frame = TrackersOn(
      *(*body)->model(), (*body)->model()->skeleton->rest_positions(), false);
  using testing::Fails;
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT((*body)->Update(TrackerFrame(), kFrameTime),
              Fails(kInvalid, "head"));
  EXPECT_THAT((*body)->Update(frame, 0), Fails(kInvalid, "dt_s"));
  ASSERT_TRUE((*body)->Update(frame, kFrameTime).ok());
  const Eigen::VectorXd before = (*body)->positions();
  TrackerFrame bad = frame;
  bad.hands[kRight]->translation.x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT((*body)->Update(bad, kFrameTime), Fails(kInvalid, "hands[1]"));
  EXPECT_EQ((*body)->positions(), before);
  frame.hands[kRight].reset();
  for (int f = 0; f < 20; ++f) {
    ASSERT_TRUE((*body)->Update(frame, kFrameTime).ok());
  }
  WorldTransforms at;
  ForwardKinematics(*(*body)->model()->skeleton, (*body)->positions(), at);
  const int hand = (*body)->model()->map.joint(BodyRole::kRightHand);
  EXPECT_LT(at[hand].translation.x(), -0.5);
  EXPECT_THAT(TrackerBody::Create(0.1).status(), Fails(kInvalid, "height_m"));
}

}  // namespace
}  // namespace gelenk
