#include "gelenk/retarget/rig_pose.h"

#include <cmath>
#include <utility>

#include "gelenk/math/rotation.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

// The part of `rotation` that is a turn about `axis`, rad.
double TwistAbout(const Vector3d& axis, const Quaterniond& rotation) {
  const double along = rotation.vec().dot(axis);
  return 2 *
         std::atan2(rotation.w() < 0 ? -along : along, std::abs(rotation.w()));
}

}  // namespace

RigPose::RigPose(std::shared_ptr<const BodyModel> model)
    : model_(std::move(model)) {
  const Skeleton& skeleton = *model_->skeleton;
  const int count = skeleton.joint_count();
  WorldTransforms reference;
  ForwardKinematics(skeleton, model_->reference.positions, reference);
  wanted_.assign(count, false);
  above_.assign(count, false);
  above_from_pelvis_.assign(count, Vector3d::Zero());
  for (const RigidTransform& world_from_joint : reference) {
    orientations_.push_back(model_->canonical_from_world *
                            world_from_joint.rotation);
    places_.push_back(model_->canonical_from_world *
                      world_from_joint.translation);
  }
  // A body without legs is carried by its root.
  pelvis_ = model_->map.joint(BodyRole::kPelvis);
  if (pelvis_ < 0) pelvis_ = 0;
  for (int i = skeleton.span(pelvis_).parent; i >= 0;
       i = skeleton.span(i).parent) {
    above_[i] = true;
    above_from_pelvis_[i] = places_[i] - places_[pelvis_];
  }
  for (int i = pelvis_; i >= 0 && carrier_ < 0; i = skeleton.span(i).parent) {
    if (skeleton.joint(i).type == JointType::kFree) carrier_ = i;
  }
  pelvis_place_ = places_[pelvis_];
}

void RigPose::SetWanted(int joint, const Quaterniond& orientation) {
  // A base that is fixed stays as it is.
  if (joint == pelvis_ && carrier_ < 0) return;
  wanted_[joint] = true;
  orientations_[joint] = orientation;
}

void RigPose::Follow() {
  const Skeleton& skeleton = *model_->skeleton;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    if (above_[i]) {
      // What the carrier hangs on stays where it is.
      if (carrier_ >= 0 && i >= carrier_) {
        places_[i] = pelvis_place_ + above_from_pelvis_[i];
      }
      continue;
    }
    const int parent = skeleton.span(i).parent;
    if (parent < 0) {
      if (carrier_ >= 0) places_[i] = pelvis_place_;
      continue;
    }
    const RigidTransform& in_parent = model_->parent_from_joint[i];
    if (!wanted_[i]) {
      orientations_[i] = orientations_[parent] * in_parent.rotation;
    }
    places_[i] =
        i == pelvis_ && carrier_ == i
            ? pelvis_place_
            : places_[parent] + orientations_[parent] * in_parent.translation;
  }
}

void RigPose::Shift(const Vector3d& way) {
  pelvis_place_ += way;
  if (carrier_ < 0) return;
  for (size_t i = carrier_; i < places_.size(); ++i) places_[i] += way;
}

void RigPose::Store(VectorView positions) const {
  const Skeleton& skeleton = *model_->skeleton;
  positions = model_->reference.positions;
  const Quaterniond world_from_canonical =
      model_->canonical_from_world.conjugate();
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const JointSpan& span = skeleton.span(i);
    if (span.position_offset < 0) continue;
    const Joint& joint = skeleton.joint(i);
    const bool is_carrier = i == carrier_;
    if (!wanted_[i] && !is_carrier) continue;
    const RigidTransform world_from_parent =
        span.parent < 0
            ? RigidTransform()
            : RigidTransform{world_from_canonical * orientations_[span.parent],
                             world_from_canonical * places_[span.parent]};
    const RigidTransform world_from_rest =
        world_from_parent * joint.parent_from_joint;
    const Quaterniond turn = world_from_rest.rotation.conjugate() *
                             (world_from_canonical * orientations_[i]);
    double* q = positions.data() + span.position_offset;
    if (joint.type == JointType::kRevolute) {
      *q = TwistAbout(joint.axis, turn);
    }
    if (is_carrier) {
      const Vector3d way =
          world_from_rest.Inverse() * (world_from_canonical * places_[i]);
      for (int k = 0; k < 3; ++k) q[k] = way[k];
    }
    if (span.quaternion_offset >= 0) {
      StoreXyzw(turn.normalized(), positions.data() + span.quaternion_offset);
    }
  }
}

void RigPose::ReadBody(BodyPose& pose) const {
  const JointMap& map = model_->map;
  std::array<bool, kBodyRoleCount> has;
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const int joint = map.roles[i].joint;
    has[i] = joint >= 0;
    if (joint < 0) continue;
    pose.rotations[i] =
        orientations_[joint] * model_->anatomy[joint].conjugate();
    pose.positions[i] = places_[joint];
  }
  FillMissingRoles(has, pose);
  pose.hip_center = (pose.position(BodyRole::kLeftThigh) +
                     pose.position(BodyRole::kRightThigh)) /
                    2;
  for (int side : kSides) {
    const LegRoles& leg = kLegRoles[side];
    const FootShape& shape = model_->feet[side];
    auto& points = pose.foot_points[side];
    points.fill(pose.position(leg.foot));
    if (!map.HasLeg(side)) continue;
    const int foot = map.joint(leg.foot);
    points[kHeel] += orientations_[foot] * shape.heel;
    points[kBall] += orientations_[foot] * shape.ball;
    points[kTip] = points[kBall];
    if (shape.has_tip) {
      points[kTip] += orientations_[map.joint(leg.toe)] * shape.tip;
    }
  }
}

}  // namespace gelenk
