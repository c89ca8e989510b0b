#include "gelenk/retarget/rotation_transfer.h"

#include <algorithm>
#include <utility>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

double MeanAnkle(const BodyModel& model) {
  return (model.feet[kLeft].ankle_height + model.feet[kRight].ankle_height) / 2;
}

bool Contains(const std::vector<int>& chain, int joint) {
  return std::find(chain.begin(), chain.end(), joint) != chain.end();
}

}  // namespace

RotationTransfer::RotationTransfer(std::shared_ptr<const BodyModel> source,
                                   std::shared_ptr<const BodyModel> target,
                                   std::optional<double> root_scale)
    : source_(std::move(source)),
      target_(std::move(target)),
      scale_(target_->leg_length / source_->leg_length),
      root_scale_(root_scale.value_or(scale_)) {
  const JointMap& map = target_->map;
  for (size_t i = 0; i < map.spine.size(); ++i) {
    spine_.push_back({map.spine[i], PlaceOnChain(source_->spine_fractions,
                                                 target_->spine_fractions[i])});
  }
  for (size_t i = 0; i < map.neck.size(); ++i) {
    neck_.push_back({map.neck[i], PlaceOnChain(source_->neck_fractions,
                                               target_->neck_fractions[i])});
  }
  for (int i = 0; i < kBodyRoleCount; ++i) {
    const int joint = map.roles[i].joint;
    if (joint < 0 || Contains(map.spine, joint) || Contains(map.neck, joint)) {
      continue;
    }
    roles_.push_back({joint, static_cast<BodyRole>(i)});
  }
  if (!target_->map.HasLegs() || !source_->map.HasLegs()) return;
  source_ankle_ = MeanAnkle(*source_);
  target_ankle_ = MeanAnkle(*target_);
  WorldTransforms reference;
  ForwardKinematics(*target_->skeleton, target_->reference.positions,
                    reference);
  const RigidTransform pelvis_from_world =
      reference[map.joint(BodyRole::kPelvis)].Inverse();
  for (int side : kSides) {
    const int thigh = map.joint(kLegRoles[side].thigh);
    pelvis_from_hip_center_ +=
        pelvis_from_world * reference[thigh].translation / 2;
  }
}

Vector3d RotationTransfer::PelvisPlace(const BodyPose& source,
                                       const Quaterniond& pelvis,
                                       double source_floor_m,
                                       double target_floor_m) const {
  const Vector3d& from = source.hip_center;
  const Vector3d hip_center(
      root_scale_ * from.x(),
      scale_ * (from.y() - source_floor_m - source_ankle_) + target_ankle_ +
          target_floor_m,
      root_scale_ * from.z());
  return hip_center - pelvis * pelvis_from_hip_center_;
}

void RotationTransfer::Apply(const BodyPose& source, double source_floor_m,
                             double target_floor_m, RigPose& rig) const {
  const std::vector<Quaterniond>& anatomy = target_->anatomy;
  for (const RoleTurn& turn : roles_) {
    rig.SetWanted(turn.joint, source.rotation(turn.role) * anatomy[turn.joint]);
  }
  const Quaterniond& pelvis = source.rotation(BodyRole::kPelvis);
  const Quaterniond& chest = source.rotation(BodyRole::kChest);
  for (const ChainTurn& turn : spine_) {
    rig.SetWanted(turn.joint,
                  OrientationAt(turn.place, pelvis, source.spine, chest) *
                      anatomy[turn.joint]);
  }
  const Quaterniond& head = source.rotation(BodyRole::kHead);
  for (const ChainTurn& turn : neck_) {
    rig.SetWanted(turn.joint,
                  OrientationAt(turn.place, chest, source.neck, head) *
                      anatomy[turn.joint]);
  }
  if (target_->map.Has(BodyRole::kPelvis)) {
    rig.SetPelvis(PelvisPlace(source, rig.orientation(BodyRole::kPelvis),
                              source_floor_m, target_floor_m));
  }
  rig.Follow();
}

}  // namespace gelenk
