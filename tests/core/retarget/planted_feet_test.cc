// Feet on uneven ground, feet that turn, and no memory taken.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gelenk/math/rotation.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/retarget_clip.h"
#include "gelenk/retarget/tracker_body.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/retarget_runs.h"
#include "tests/testing/rig_family.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using testing::SourceClip;

constexpr double kFrameTime = 0.01;

std::shared_ptr<const BodyModel> Humanoid() {
  const auto skeleton = MakeHumanoid();
  return *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
}

// The humanoid with its hips at `hips`, turned by `yaw_rad`, otherwise at rest.
Eigen::VectorXd Standing(const Skeleton& skeleton, const Eigen::Vector3d& hips,
                         double yaw_rad) {
  Eigen::VectorXd positions = skeleton.rest_positions();
  positions.head<3>() = hips;
  StoreXyzw(
      Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY())),
      positions.data() + 3);
  return positions;
}

TEST(PlantedFeetTest, FeetStandOnAHeightField) {
  // A ramp along Z: 0.2 m a metre.
  Eigen::MatrixXd heights(2, 61);
  for (int k = 0; k < 61; ++k) heights.col(k).setConstant(0.02 * k);
  RetargetOptions options;
  options.target_ground = *HeightField::Create(heights, -3, 0, 0.1);
  const auto clip = testing::BodyClipFromBvh(testing::WalkingBvh(200), "walk");
  const SourceClip source = testing::MakeSource(*clip);
  const auto target = Humanoid();
  auto retargeter = Retargeter::Create(source.clip.model, target, options);
  ASSERT_TRUE(retargeter.ok());
  BodyPose pose;
  BodyPoseReader reader(target);
  double first_hips = 0;
  for (int f = 0; f < source.clip.frame_count(); ++f) {
    (*retargeter)->RetargetBody(source.poses[f], source.clip.frame_time_s);
    reader.Read((*retargeter)->positions(), pose);
    if (f == 0) first_hips = pose.hip_center.y();
    for (int side : kSides) {
      for (int point = 0; point < kFootPointCount; ++point) {
        const Eigen::Vector3d& at = pose.foot_points[side][point];
        ASSERT_GT(at.y() - target->planted_heights[side][point] -
                      options.target_ground->HeightAt(at),
                  -0.005)
            << "frame " << f << " side " << side << " point " << point;
      }
    }
  }
  // The body climbed with the ramp.
  EXPECT_NEAR(pose.hip_center.y() - first_hips, 0.2 * pose.hip_center.z(), 0.1);
  EXPECT_GT(pose.hip_center.z(), 1);
}

TEST(PlantedFeetTest, AFootTurnsFreelyOnItsBall) {
  // The whole body turns about the left ball at 60 degrees a second.
  const auto model = Humanoid();
  auto retargeter = Retargeter::Create(model, model);
  ASSERT_TRUE(retargeter.ok());
  const Skeleton& skeleton = *model->skeleton;
  BodyPose at_rest;
  BodyPoseReader reader(model);
  reader.Read(skeleton.rest_positions(), at_rest);
  const Eigen::Vector3d ball = at_rest.foot_points[kLeft][kBall];
  const Eigen::Vector3d hips = skeleton.rest_positions().head<3>();
  BodyPose pose;
  double heel_turned = 0;
  for (int f = 0; f < 150; ++f) {
    const double yaw =
        std::max(0.0, f * kFrameTime - 0.3) * std::numbers::pi / 3;
    const Eigen::AngleAxisd turn(yaw, Eigen::Vector3d::UnitY());
    const Eigen::Vector3d center = Horizontal(ball);
    ASSERT_TRUE(
        (*retargeter)
            ->Retarget(Standing(skeleton, center + turn * (hips - center), yaw),
                       kFrameTime)
            .ok());
    reader.Read((*retargeter)->positions(), pose);
    // The ball stays where it stood.
    ASSERT_LT(Horizontal(pose.foot_points[kLeft][kBall] - ball).norm(), 0.02)
        << f;
    const Eigen::Vector3d ahead = Horizontal(pose.foot_points[kLeft][kBall] -
                                             pose.foot_points[kLeft][kHeel]);
    heel_turned = std::abs(yaw - std::atan2(ahead.x(), ahead.z()));
  }
  // 70 degrees turned; the foot came along, but for what it lags.
  EXPECT_LT(heel_turned, 15 * std::numbers::pi / 180);
}

// Knees that bend by 15 degrees only: the walk has 38.
std::shared_ptr<const BodyModel> StiffHumanoid() {
  const auto free = MakeHumanoid();
  SkeletonBuilder builder;
  for (Joint joint : free->joints()) {
    if (joint.id == "left_shin") {
      joint.limits.swing_cone_rad = 15 * std::numbers::pi / 180;
    }
    builder.AddJoint(std::move(joint));
  }
  for (const EndEffector& end : free->end_effectors()) {
    builder.AddEndEffector(end);
  }
  const auto stiff = *builder.SetRestPositions(free->rest_positions()).Build();
  return *MakeBodyModel(stiff, *ProposeJointMap(*stiff));
}

TEST(PlantedFeetTest, LimitsOfTheTargetHold) {
  const auto clip = testing::BodyClipFromBvh(testing::WalkingBvh(150), "walk");
  const SourceClip source = testing::MakeSource(*clip);
  for (auto way :
       {testing::RetargetWay::kOnline, testing::RetargetWay::kOffline}) {
    const auto run = RunRetarget(source, StiffHumanoid(), way);
    ASSERT_TRUE(run.ok());
    EXPECT_GT(run->limited_part, 0.1);
    EXPECT_LT(run->limit_excess, 1e-6);
    EXPECT_LE(run->comparison.largest_extra_turn_deg, 25);
  }
}

TEST(PlantedFeetTest, AWarmFrameTakesNoMemory) {
  const auto clip = testing::BodyClipFromBvh(testing::WalkingBvh(300), "walk");
  for (const auto& target : {Humanoid(), StiffHumanoid()}) {
    auto retargeter = Retargeter::Create(clip->model, target);
    ASSERT_TRUE(retargeter.ok());
    double worst_excess = 0;
    int before = 0;
    for (int f = 0; f < 300; ++f) {
      if (f == 150) before = testing::AllocationCount();
      const absl::Status status =
          (*retargeter)->Retarget(clip->positions.col(f), clip->frame_time_s);
      ASSERT_TRUE(status.ok());
      worst_excess =
          std::max(worst_excess, (*retargeter)->report().limit_excess);
    }
    EXPECT_EQ(testing::AllocationCount(), before);
    // The stiff one was solved again and again.
    const bool is_stiff =
        target->skeleton->joint(target->map.joint(BodyRole::kLeftShin))
            .limits.swing_cone_rad < 1;
    EXPECT_EQ(worst_excess > 0, is_stiff);
  }
}

TEST(PlantedFeetTest, AWarmFrameOfTrackersTakesNoMemory) {
  const auto body = TrackerBody::Create();
  ASSERT_TRUE(body.ok());
  TrackerFrame frame;
  int before = 0;
  for (int f = 0; f < 100; ++f) {
    if (f == 50) before = testing::AllocationCount();
    frame.head = RigidTransform{Eigen::Quaterniond::Identity(),
                                Eigen::Vector3d(0, 1.6, 0.01 * f)};
    for (int side : kSides) {
      frame.hands[side] = RigidTransform{
          Eigen::Quaterniond::Identity(),
          Eigen::Vector3d(side == kLeft ? 0.4 : -0.4, 1.1, 0.2 + 0.01 * f)};
    }
    const absl::Status status = (*body)->Update(frame, kFrameTime);
    ASSERT_TRUE(status.ok());
  }
  EXPECT_EQ(testing::AllocationCount(), before);
}

}  // namespace
}  // namespace gelenk
