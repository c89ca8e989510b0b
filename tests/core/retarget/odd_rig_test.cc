// The traps of real files: joints whose axes mean nothing, rest poses that lie,
// worlds whose up is another axis, first frames that are none of the motion,
// other units, names that say nothing.

#include <gtest/gtest.h>

#include "gelenk/math/rotation.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/random.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/retarget_runs.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::BodyClip;
using testing::RetargetRun;
using testing::RetargetWay;

BodyClip Walk(int frames = 200) {
  return *testing::BodyClipFromBvh(testing::WalkingBvh(frames), "walk");
}

// A clip on another rig of the same body.
struct Recording {
  std::shared_ptr<const Skeleton> skeleton;
  Eigen::MatrixXd positions;
};

BodyClip ClipOf(const Recording& recording, double frame_time_s,
                int first_frame = 0) {
  const ClipView view = {recording.positions, frame_time_s, first_frame};
  const auto map = ProposeJointMap(*recording.skeleton, {}, &view);
  BodyClip clip;
  clip.model = *MakeBodyModel(recording.skeleton, *map, &view);
  clip.positions =
      recording.positions.rightCols(recording.positions.cols() - first_frame);
  clip.frame_time_s = frame_time_s;
  return clip;
}

// The same motion on a rig whose joints' frames are turned by `turns`, one for
// each joint; with all angles zero its bones lie as the turns have them.
Recording WithTurnedFrames(const BodyClip& clip,
                           const std::vector<Quaterniond>& turns,
                           const Vector3d& up = Vector3d::UnitY()) {
  const Skeleton& skeleton = *clip.model->skeleton;
  Recording recording;
  SkeletonBuilder builder;
  const auto turn_of = [&](int joint) {
    return joint < 0 ? Quaterniond::Identity() : turns[joint];
  };
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    Joint joint = skeleton.joint(i);
    const Quaterniond parent = turn_of(skeleton.span(i).parent);
    joint.parent_from_joint.translation =
        parent.conjugate() * joint.parent_from_joint.translation;
    builder.AddJoint(joint);
  }
  for (EndEffector end : skeleton.end_effectors()) {
    const Quaterniond turn = turn_of(skeleton.FindJoint(end.joint_id));
    end.joint_from_end_effector.translation =
        turn.conjugate() * end.joint_from_end_effector.translation;
    builder.AddEndEffector(end);
  }
  recording.skeleton = *builder.SetUp(up).Build();
  recording.positions = clip.positions;
  for (int f = 0; f < clip.frame_count(); ++f) {
    for (int i = 0; i < skeleton.joint_count(); ++i) {
      const int row = skeleton.span(i).quaternion_offset;
      if (row < 0) continue;
      double* q = recording.positions.col(f).data() + row;
      const Quaterniond parent = turn_of(skeleton.span(i).parent);
      StoreXyzw(
          (parent.conjugate() * QuaternionXyzw(q) * turns[i]).normalized(), q);
    }
  }
  return recording;
}

std::shared_ptr<const BodyModel> Humanoid() {
  const auto skeleton = MakeHumanoid();
  return *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
}

RetargetRun OntoHumanoid(BodyClip clip) {
  return *RunRetarget(testing::MakeSource(std::move(clip)), Humanoid(),
                      RetargetWay::kOnline);
}

// Of hands, feet and head, m; mean over all frames.
double MeanDistance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const auto model = Humanoid();
  const auto one = testing::BodyPosesOf(*model, a);
  const auto other = testing::BodyPosesOf(*model, b);
  double sum = 0;
  for (size_t f = 0; f < one.size(); ++f) {
    for (BodyRole role :
         {BodyRole::kLeftHand, BodyRole::kRightHand, BodyRole::kLeftFoot,
          BodyRole::kRightFoot, BodyRole::kHead}) {
      sum += (one[f].position(role) - other[f].position(role)).norm();
    }
  }
  return sum / (5.0 * static_cast<double>(one.size()));
}

TEST(OddRigTest, FramesThatMeanNothingAreUnderstoodByTheClip) {
  const BodyClip walk = Walk();
  const RetargetRun expected = OntoHumanoid(walk);
  testing::Random random(7);
  for (int round = 0; round < 5; ++round) {
    std::vector<Quaterniond> turns;
    for (int i = 0; i < walk.model->skeleton->joint_count(); ++i) {
      turns.push_back(testing::RandomRotation(random));
    }
    const BodyClip odd =
        ClipOf(WithTurnedFrames(walk, turns), walk.frame_time_s);
    EXPECT_FALSE(odd.model->reference.IsRestPose());
    const RetargetRun run = OntoHumanoid(odd);
    EXPECT_LE(run.quality.penetration.max_m, 1e-3);
    EXPECT_LE(run.comparison.label_skate_ratio, 0.4);
    EXPECT_LE(run.comparison.largest_extra_turn_deg, 25);
    // A frame of the walk as the reference: spine, pelvis and feet are some
    // degrees off.
    EXPECT_LT(MeanDistance(run.positions, expected.positions), 0.08);
  }
}

TEST(OddRigTest, ARollThatTheRestPoseShowsDoesNothing) {
  // Frames turned, but so that the rest pose is still the T-pose: exact.
  const BodyClip walk = Walk(60);
  const RetargetRun expected = OntoHumanoid(walk);
  const Skeleton& skeleton = *walk.model->skeleton;
  testing::Random random(8);
  Recording rolled;
  rolled.positions = walk.positions;
  SkeletonBuilder builder;
  std::vector<Quaterniond> turns;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    turns.push_back(i == 0 ? Quaterniond::Identity()
                           : testing::RandomRotation(random));
    Joint joint = skeleton.joint(i);
    if (i > 0) {
      const Quaterniond parent = turns[skeleton.span(i).parent];
      joint.parent_from_joint = RigidTransform{parent.conjugate(), {0, 0, 0}} *
                                joint.parent_from_joint *
                                RigidTransform{turns[i], {0, 0, 0}};
      joint.parent_from_joint.rotation.normalize();
      const int row = skeleton.span(i).quaternion_offset;
      for (int f = 0; f < walk.frame_count(); ++f) {
        double* q = rolled.positions.col(f).data() + row;
        StoreXyzw(
            (turns[i].conjugate() * QuaternionXyzw(q) * turns[i]).normalized(),
            q);
      }
    }
    builder.AddJoint(joint);
  }
  for (EndEffector end : skeleton.end_effectors()) {
    end.joint_from_end_effector.translation =
        turns[skeleton.FindJoint(end.joint_id)].conjugate() *
        end.joint_from_end_effector.translation;
    builder.AddEndEffector(end);
  }
  rolled.skeleton = *builder.Build();
  const RetargetRun run = OntoHumanoid(ClipOf(rolled, walk.frame_time_s));
  EXPECT_LT(MeanDistance(run.positions, expected.positions), 1e-6);
}

TEST(OddRigTest, UpMayBeAnyAxisInTheClipAndAnotherAtRest) {
  // Rest as before, motion turned so that up is +Z: rest-up is not clip-up.
  const BodyClip walk = Walk(60);
  const RetargetRun expected = OntoHumanoid(walk);
  const Quaterniond z_up =
      ShortestRotation(Vector3d::UnitY(), Vector3d::UnitZ());
  Recording turned;
  turned.positions = walk.positions;
  for (int f = 0; f < walk.frame_count(); ++f) {
    auto root = turned.positions.col(f).head<7>();
    const Vector3d place = z_up * Vector3d(root.head<3>());
    const Quaterniond rotation = z_up * QuaternionXyzw(root.data() + 3);
    root.head<3>() = place;
    StoreXyzw(rotation.normalized(), root.data() + 3);
  }
  SkeletonBuilder builder;
  for (const Joint& joint : walk.model->skeleton->joints()) {
    builder.AddJoint(joint);
  }
  for (const EndEffector& end : walk.model->skeleton->end_effectors()) {
    builder.AddEndEffector(end);
  }
  turned.skeleton = *builder.SetUp(Vector3d::UnitZ()).Build();
  const RetargetRun run = OntoHumanoid(ClipOf(turned, walk.frame_time_s));
  EXPECT_LT(MeanDistance(run.positions, expected.positions), 1e-6);
}

TEST(OddRigTest, TheUnitDoesNotMatter) {
  const BodyClip walk = Walk(60);
  const RetargetRun expected = OntoHumanoid(walk);
  Recording large;
  large.positions = walk.positions;
  large.positions.topRows(3) *= 39.37;
  SkeletonBuilder builder;
  for (Joint joint : walk.model->skeleton->joints()) {
    joint.parent_from_joint.translation *= 39.37;
    builder.AddJoint(joint);
  }
  for (EndEffector end : walk.model->skeleton->end_effectors()) {
    end.joint_from_end_effector.translation *= 39.37;
    builder.AddEndEffector(end);
  }
  large.skeleton = *builder.Build();
  const RetargetRun run = OntoHumanoid(ClipOf(large, walk.frame_time_s));
  EXPECT_LT(MeanDistance(run.positions, expected.positions), 1e-6);
}

TEST(OddRigTest, AFirstFrameThatIsNoMotionIsAReferenceAtMost) {
  // The T-pose before the walk of a rig whose rest pose lies.
  const BodyClip walk = Walk(120);
  testing::Random random(9);
  std::vector<Quaterniond> turns;
  for (int i = 0; i < walk.model->skeleton->joint_count(); ++i) {
    turns.push_back(testing::RandomRotation(random));
  }
  BodyClip with_t_pose = walk;
  with_t_pose.positions.resize(walk.positions.rows(), walk.frame_count() + 1);
  with_t_pose.positions << walk.model->skeleton->rest_positions(),
      walk.positions;
  const BodyClip odd =
      ClipOf(WithTurnedFrames(with_t_pose, turns), walk.frame_time_s, 1);
  EXPECT_EQ(odd.frame_count(), walk.frame_count());
  EXPECT_EQ(odd.model->reference.frame, 0);
  const RetargetRun run = OntoHumanoid(odd);
  EXPECT_LT(MeanDistance(run.positions, OntoHumanoid(walk).positions), 0.05);
}

TEST(OddRigTest, WithoutNamesTheMotionTellsTheSides) {
  const BodyClip walk = Walk(120);
  // A rest pose that looks backwards: toes and arms along the wrong axes.
  std::vector<Quaterniond> turns(walk.model->skeleton->joint_count(),
                                 Quaterniond::Identity());
  for (BodyRole role : {BodyRole::kLeftFoot, BodyRole::kRightFoot,
                        BodyRole::kLeftToe, BodyRole::kRightToe}) {
    turns[walk.model->map.joint(role)] =
        Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitY()));
  }
  Recording recording = WithTurnedFrames(walk, turns);
  SkeletonBuilder builder;
  const auto nameless = [&](const std::string& id) {
    return id.empty() ? id
                      : absl::StrCat("j", recording.skeleton->FindJoint(id));
  };
  for (Joint joint : recording.skeleton->joints()) {
    joint.id = nameless(joint.id);
    joint.parent_id = nameless(joint.parent_id);
    builder.AddJoint(joint);
  }
  for (EndEffector end : recording.skeleton->end_effectors()) {
    end.joint_id = nameless(end.joint_id);
    builder.AddEndEffector(end);
  }
  recording.skeleton = *builder.Build();
  // The rest pose alone misleads.
  const auto by_rest = ProposeJointMap(*recording.skeleton);
  EXPECT_EQ(by_rest->joint(BodyRole::kLeftFoot),
            walk.model->map.joint(BodyRole::kRightFoot));
  const ClipView view = {recording.positions, walk.frame_time_s};
  const auto by_clip = ProposeJointMap(*recording.skeleton, {}, &view);
  for (int i = 0; i < kBodyRoleCount; ++i) {
    EXPECT_EQ(by_clip->roles[i].joint, walk.model->map.roles[i].joint)
        << BodyRoleName(static_cast<BodyRole>(i));
  }
}

}  // namespace
}  // namespace gelenk
