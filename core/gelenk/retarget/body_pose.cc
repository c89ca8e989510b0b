#include "gelenk/retarget/body_pose.h"

namespace gelenk {
namespace {

// What a part hangs on, parents before children.
struct Hanging {
  BodyRole part;
  BodyRole on;
};
constexpr std::array<Hanging, kBodyRoleCount - 1> kHanging = {
    {{BodyRole::kChest, BodyRole::kPelvis},
     {BodyRole::kNeck, BodyRole::kChest},
     {BodyRole::kHead, BodyRole::kNeck},
     {BodyRole::kLeftClavicle, BodyRole::kChest},
     {BodyRole::kLeftUpperArm, BodyRole::kLeftClavicle},
     {BodyRole::kLeftForearm, BodyRole::kLeftUpperArm},
     {BodyRole::kLeftHand, BodyRole::kLeftForearm},
     {BodyRole::kRightClavicle, BodyRole::kChest},
     {BodyRole::kRightUpperArm, BodyRole::kRightClavicle},
     {BodyRole::kRightForearm, BodyRole::kRightUpperArm},
     {BodyRole::kRightHand, BodyRole::kRightForearm},
     {BodyRole::kLeftThigh, BodyRole::kPelvis},
     {BodyRole::kLeftShin, BodyRole::kLeftThigh},
     {BodyRole::kLeftFoot, BodyRole::kLeftShin},
     {BodyRole::kLeftToe, BodyRole::kLeftFoot},
     {BodyRole::kRightThigh, BodyRole::kPelvis},
     {BodyRole::kRightShin, BodyRole::kRightThigh},
     {BodyRole::kRightFoot, BodyRole::kRightShin},
     {BodyRole::kRightToe, BodyRole::kRightFoot}}};

void ReadChain(const BodyModel& model, const std::vector<int>& chain,
               const WorldTransforms& world_from_joints,
               std::vector<Eigen::Quaterniond>& rotations) {
  rotations.resize(chain.size());
  for (size_t i = 0; i < chain.size(); ++i) {
    rotations[i] = model.canonical_from_world *
                   world_from_joints[chain[i]].rotation *
                   model.anatomy[chain[i]].conjugate();
  }
}

}  // namespace

void FillMissingRoles(const std::array<bool, kBodyRoleCount>& has,
                      BodyPose& pose) {
  if (!has[IndexOf(BodyRole::kPelvis)]) {
    pose.rotations[IndexOf(BodyRole::kPelvis)].setIdentity();
    pose.positions[IndexOf(BodyRole::kPelvis)].setZero();
  }
  for (const Hanging& hanging : kHanging) {
    const int part = IndexOf(hanging.part);
    if (has[part]) continue;
    pose.rotations[part] = pose.rotation(hanging.on);
    pose.positions[part] = pose.position(hanging.on);
  }
}

void ReadBodyPose(const BodyModel& model,
                  const WorldTransforms& world_from_joints, BodyPose& pose) {
  const JointMap& map = model.map;
  std::array<bool, kBodyRoleCount> has;
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const int joint = map.roles[i].joint;
    has[i] = joint >= 0;
    if (joint < 0) continue;
    pose.rotations[i] = model.canonical_from_world *
                        world_from_joints[joint].rotation *
                        model.anatomy[joint].conjugate();
    pose.positions[i] =
        model.canonical_from_world * world_from_joints[joint].translation;
  }
  FillMissingRoles(has, pose);
  ReadChain(model, map.spine, world_from_joints, pose.spine);
  ReadChain(model, map.neck, world_from_joints, pose.neck);
  pose.hip_center = (pose.position(BodyRole::kLeftThigh) +
                     pose.position(BodyRole::kRightThigh)) /
                    2;
  for (int side : kSides) {
    const LegRoles& leg = kLegRoles[side];
    const FootShape& shape = model.feet[side];
    auto& points = pose.foot_points[side];
    points.fill(pose.position(leg.foot));
    if (!map.HasLeg(side)) continue;
    const RigidTransform& foot = world_from_joints[map.joint(leg.foot)];
    points[kHeel] = model.canonical_from_world * (foot * shape.heel);
    points[kBall] = model.canonical_from_world * (foot * shape.ball);
    points[kTip] = points[kBall];
    if (shape.has_tip) {
      points[kTip] +=
          model.canonical_from_world *
          (world_from_joints[map.joint(leg.toe)].rotation * shape.tip);
    }
  }
}

void BodyPoseReader::Read(const ConstVectorView& positions, BodyPose& pose) {
  ForwardKinematics(*model_->skeleton, positions, world_from_joints_);
  ReadBodyPose(*model_, world_from_joints_, pose);
}

}  // namespace gelenk
