#include "gelenk/skin/volume_rig.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// What the planes of a joint are apart from it, as a part of a link.
constexpr double kSpacing = 1.0 / 6;

bool IsMoving(const Joint& joint) { return joint.type != JointType::kFixed; }

bool HasQuaternion(JointType type) {
  return type == JointType::kSpherical || type == JointType::kFree;
}

bool CanDrive(JointType type) {
  return type == JointType::kRevolute || type == JointType::kPlanar ||
         HasQuaternion(type);
}

void CheckScale(double value, const std::string& field,
                Violations& violations) {
  if (value > 0 && value <= kMaxMuscleScale) return;
  violations.Add(field, absl::StrCat("want a scale in (0, ", kMaxMuscleScale,
                                     "], got ", value));
}

}  // namespace

// Checks the muscles, and puts them into the form that a pose needs.
class MuscleCompiler {
 public:
  explicit MuscleCompiler(VolumeRig& rig) : rig_(rig) {}

  absl::Status Compile(const SkinMuscles& given) {
    rig_.compiled_.clear();
    rig_.fullness_.assign(rig_.link_count(), 0);
    rig_.volume_goals_.assign(rig_.link_count(), {});
    if (given.muscles.size() > kMaxMuscles) {
      violations_.Add("muscles", absl::StrCat("want at most ", kMaxMuscles,
                                              ", got ", given.muscles.size()));
      return violations_.ToStatus();
    }
    for (size_t i = 0; i < given.muscles.size(); ++i) {
      AddMuscle(given.muscles[i], absl::StrCat("muscles[", i, "]"));
    }
    for (size_t i = 0; i < given.fullness.size(); ++i) {
      AddFullness(given.fullness[i], absl::StrCat("fullness[", i, "]"));
    }
    // A pose goes through them link by link.
    std::stable_sort(
        rig_.compiled_.begin(), rig_.compiled_.end(),
        [](const auto& a, const auto& b) { return a.link < b.link; });
    rig_.muscles_ = given;
    return violations_.ToStatus();
  }

 private:
  int FindLink(const std::string& id, const std::string& field) {
    const int link = rig_.FindLink(id);
    if (link < 0) {
      violations_.Add(field + ".link_id", absl::StrCat("no link \"", id, "\""));
    }
    return link;
  }

  void AddMuscle(const Muscle& given, const std::string& field) {
    if (given.id.empty() || given.id.size() > 63) {
      violations_.Add(
          field + ".muscle_id",
          absl::StrCat("want 1 to 63 bytes, got ", given.id.size()));
    } else if (!ids_.insert(given.id).second) {
      violations_.Add(field + ".muscle_id",
                      absl::StrCat("\"", given.id, "\" is there twice"));
    }
    const int link = FindLink(given.link_id, field);
    if (!given.pivot_m.allFinite()) {
      violations_.Add(field + ".pivot_m", "want finite numbers");
    }
    VolumeRig::CompiledMuscle muscle = {};
    muscle.link = link;
    muscle.mode = given.mode;
    muscle.pivot_m = given.pivot_m;
    switch (given.mode) {
      case MuscleMode::kDriven:
        SetDriver(given, field, muscle);
        break;
      case MuscleMode::kExplicit:
        for (int k = 0; k < 2; ++k) {
          CheckScale(given.scale_s[k], absl::StrCat(field, ".scale_s[", k, "]"),
                     violations_);
          CheckScale(given.scale_t[k], absl::StrCat(field, ".scale_t[", k, "]"),
                     violations_);
          muscle.scales[k] = {given.scale_s[k], given.scale_t[k]};
        }
        break;
      case MuscleMode::kPreserveVolume:
        SetVolumeGoal(given, field, link);
        return;
    }
    if (link >= 0) rig_.compiled_.push_back(muscle);
  }

  void SetDriver(const Muscle& given, const std::string& field,
                 VolumeRig::CompiledMuscle& muscle) {
    for (double gain : {given.gain_s, given.gain_t}) {
      // 1 + gain must stay a scale.
      if (!(gain > -1 && gain <= kMaxMuscleScale)) {
        violations_.Add(field + ".gain",
                        absl::StrCat("want a number in (-1, ", kMaxMuscleScale,
                                     "], got ", gain));
      }
    }
    muscle.scales[0] = muscle.scales[1] = {given.gain_s, given.gain_t};
    const Skeleton& skeleton = *rig_.skeleton_;
    muscle.driver = skeleton.FindJoint(given.driver_joint_id);
    if (muscle.driver < 0) {
      violations_.Add(field + ".driver_joint_id",
                      absl::StrCat("no joint \"", given.driver_joint_id, "\""));
      return;
    }
    const JointType type = skeleton.joint(muscle.driver).type;
    const JointSpan& span = skeleton.span(muscle.driver);
    const Eigen::VectorXd& rest = rig_.rest_positions_;
    if (!CanDrive(type)) {
      violations_.Add(field + ".driver_joint_id",
                      absl::StrCat("\"", given.driver_joint_id, "\" is ",
                                   JointTypeName(type), ": it does not turn"));
    } else if (HasQuaternion(type)) {
      muscle.driver_from_rest =
          QuaternionXyzw(rest.data() + span.quaternion_offset).conjugate();
    } else if (type == JointType::kPlanar) {
      muscle.rest_angle_rad = rest[span.position_offset + 2];
    } else {
      muscle.rest_angle_rad = ScalarPosition(skeleton, rest, muscle.driver);
    }
  }

  void SetVolumeGoal(const Muscle& given, const std::string& field, int link) {
    CheckScale(given.min_scale, field + ".min_scale", violations_);
    CheckScale(given.max_scale, field + ".max_scale", violations_);
    if (given.min_scale > given.max_scale) {
      violations_.Add(
          field + ".min_scale",
          absl::StrCat(given.min_scale, " > max_scale ", given.max_scale));
    }
    if (!given.pivot_m.isZero()) {
      violations_.Add(field + ".pivot_m",
                      "preserves volume about the centre: want 0, 0");
    }
    if (link < 0) return;
    VolumeRig::VolumeGoal& goal = rig_.volume_goals_[link];
    if (goal.volume_per_section != 0) {
      violations_.Add(
          field + ".link_id",
          absl::StrCat("\"", given.link_id, "\" preserves its volume already"));
    }
    goal = {1, given.min_scale, given.max_scale};
  }

  void AddFullness(const JointFullness& given, const std::string& field) {
    const int link = FindLink(given.link_id, field);
    if (!(given.fullness >= 0 && given.fullness <= 1)) {
      violations_.Add(field + ".fullness",
                      absl::StrCat("want 0 to 1, got ", given.fullness));
    }
    if (link < 0) return;
    if (rig_.links_[link].parent < 0) {
      violations_.Add(field + ".link_id",
                      absl::StrCat("\"", given.link_id,
                                   "\" is the root: it bends against nothing"));
    }
    rig_.fullness_[link] = given.fullness;
  }

  VolumeRig& rig_;
  Violations violations_;
  absl::flat_hash_set<std::string> ids_;
};

VolumeRig::VolumeRig(std::shared_ptr<const Skeleton> skeleton,
                     std::vector<SkinLink> links,
                     Eigen::VectorXd rest_positions)
    : skeleton_(std::move(skeleton)),
      rest_positions_(std::move(rest_positions)),
      links_(std::move(links)),
      tree_(*skeleton_) {
  CompileJoints();
}

absl::StatusOr<std::shared_ptr<const VolumeRig>> VolumeRig::Create(
    std::shared_ptr<const Skeleton> skeleton, const SkinLinkOptions& options,
    const SkinMuscles& muscles) {
  absl::StatusOr<std::vector<SkinLink>> links =
      DeriveSkinLinks(*skeleton, options);
  if (!links.ok()) return links.status();
  Eigen::VectorXd rest = RestPositionsOf(*skeleton, options);
  // They were checked; this makes quaternions that are nearly unit unit.
  if (absl::Status status = CheckPositions(*skeleton, rest); !status.ok()) {
    return status;
  }
  std::shared_ptr<VolumeRig> rig(
      new VolumeRig(std::move(skeleton), *std::move(links), std::move(rest)));
  if (absl::Status status = rig->SetMuscles(muscles); !status.ok()) {
    return status;
  }
  return rig;
}

absl::StatusOr<std::shared_ptr<const VolumeRig>> VolumeRig::WithMuscles(
    const SkinMuscles& muscles) const {
  auto rig = std::make_shared<VolumeRig>(*this);
  if (absl::Status status = rig->SetMuscles(muscles); !status.ok()) {
    return status;
  }
  return rig;
}

std::shared_ptr<const VolumeRig> VolumeRig::WithHalfExtents(
    absl::Span<const Eigen::Vector2d> half_extents_m) const {
  auto rig = std::make_shared<VolumeRig>(*this);
  for (int i = 0; i < link_count(); ++i) {
    rig->links_[i].half_extents_m = half_extents_m[i];
  }
  return rig;
}

std::shared_ptr<const VolumeRig> VolumeRig::WithSections(
    absl::Span<const LinkSection> sections) const {
  auto rig = std::make_shared<VolumeRig>(*this);
  for (int i = 0; i < link_count(); ++i) {
    rig->links_[i].half_extents_m = sections[i].half_extents_m;
    rig->links_[i].cap_reach_m = sections[i].cap_reach_m;
  }
  return rig;
}

int VolumeRig::FindLink(absl::string_view id) const {
  for (int i = 0; i < link_count(); ++i) {
    if (links_[i].id == id) return i;
  }
  return -1;
}

int VolumeRig::volume(int link, VolumePart part) const {
  if (part == VolumePart::kStub) {
    return kVolumesPerLink * link_count() + stubs_[link];
  }
  return kVolumesPerLink * link + static_cast<int>(part);
}

int VolumeRig::volume_link(int volume) const {
  const int stub = volume - kVolumesPerLink * link_count();
  return stub < 0 ? volume / kVolumesPerLink : stub_links_[stub];
}

VolumePart VolumeRig::volume_part(int volume) const {
  return volume >= kVolumesPerLink * link_count()
             ? VolumePart::kStub
             : static_cast<VolumePart>(volume % kVolumesPerLink);
}

void VolumeRig::CompileJoints() {
  const int count = link_count();
  start_spacings_.resize(count);
  end_spacings_.resize(count);
  chains_.resize(count);
  stubs_.assign(count, -1);
  joints_.resize(count);
  WorldTransforms world_from_joints;
  ForwardKinematics(*skeleton_, rest_positions_, world_from_joints);
  std::vector<RigidTransform> world_from_links(count);
  int chain_count = 0;
  for (int i = 0; i < count; ++i) {
    const SkinLink& link = links_[i];
    world_from_links[i] = world_from_joints[link.joint] * link.joint_from_link;
    start_spacings_[i] = end_spacings_[i] = kSpacing * link.length_m;
    JointMotion& motion = joints_[i];
    motion.joint_from_link = link.joint_from_link.rotation.toRotationMatrix();
    motion.parent_from_stem.setIdentity();
    motion.stem_from_rest.setIdentity();
    motion.parent_origin.setZero();
    motion.axis.setZero();
    if (link.parent < 0) {
      chains_[i] = chain_count++;
      continue;
    }
    const SkinLink& parent = links_[link.parent];
    const double spacing = kSpacing * std::min(link.length_m, parent.length_m);
    start_spacings_[i] = spacing;
    if (parent.continuation == i) {
      end_spacings_[link.parent] = spacing;
      chains_[i] = chains_[link.parent];
    } else {
      chains_[i] = chain_count++;
      stubs_[i] = static_cast<int>(stub_links_.size());
      stub_links_.push_back(i);
    }
    const RigidTransform parent_from_link =
        world_from_links[link.parent].Inverse() * world_from_links[i];
    (is_branch(i) ? motion.parent_from_stem : motion.stem_from_rest) =
        parent_from_link.rotation.normalized();
    motion.parent_origin = parent_from_link.translation;
    CompileMotion(i, world_from_joints);
  }
}

void VolumeRig::CompileMotion(int i, const WorldTransforms& world_from_joints) {
  JointMotion& motion = joints_[i];
  const SkinLink& link = links_[i];
  int moving = -1;
  for (int j = link.joint; j != links_[link.parent].joint;
       j = skeleton_->span(j).parent) {
    if (!IsMoving(skeleton_->joint(j))) continue;
    if (moving >= 0) return;
    moving = j;
  }
  if (moving < 0) return;
  const Joint& joint = skeleton_->joint(moving);
  const Quaterniond moved_from_link =
      (world_from_joints[moving].rotation.conjugate() *
       world_from_joints[link.joint].rotation * link.joint_from_link.rotation)
          .normalized();
  if (joint.type == JointType::kRevolute) {
    motion.hinge = moving;
    motion.axis = moved_from_link.conjugate() * joint.axis;
    motion.rest_angle_rad = ScalarPosition(*skeleton_, rest_positions_, moving);
  } else if (joint.type == JointType::kSpherical) {
    motion.ball = moving;
    motion.after = moved_from_link;
    motion.before = motion.stem_from_rest * moved_from_link.conjugate() *
                    QuaternionXyzw(rest_positions_.data() +
                                   skeleton_->span(moving).quaternion_offset)
                        .conjugate();
  }
}

absl::Status VolumeRig::SetMuscles(const SkinMuscles& muscles) {
  absl::Status status = MuscleCompiler(*this).Compile(muscles);
  if (status.ok()) EvaluateRest();
  return status;
}

std::vector<VolumeFold> VolumeRig::FindFolds(const VolumeFrame& frame) const {
  std::vector<VolumeFold> folds;
  for (int i = 0; i < volume_count(); ++i) {
    if (volume_part(i) == VolumePart::kRigid) continue;
    const double least =
        frame.volume(i).LeastJacobian(links_[volume_link(i)].half_extents_m);
    if (least > 0) continue;
    const double at_rest =
        rest_.volume(i).Evaluate({0.5, 0, 0}).Jacobian().determinant();
    folds.push_back({i, least / at_rest});
  }
  return folds;
}

}  // namespace gelenk
