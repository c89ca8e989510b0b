#include "convert/muscle.h"

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

// False when there is no mode.
bool ModeFromProto(const v1::Muscle& proto, Muscle& muscle) {
  switch (proto.mode_case()) {
    case v1::Muscle::kDriven: {
      const v1::DrivenMuscle& driven = proto.driven();
      muscle.mode = MuscleMode::kDriven;
      muscle.driver_joint_id = driven.driver_joint_id();
      muscle.gain_s = driven.gain_s();
      muscle.gain_t = driven.gain_t();
      muscle.pivot_m = {driven.pivot_s_m(), driven.pivot_t_m()};
      return true;
    }
    case v1::Muscle::kExplicitScales: {
      const v1::ExplicitScales& scales = proto.explicit_scales();
      muscle.mode = MuscleMode::kExplicit;
      if (scales.has_scale_s_p2()) muscle.scale_s[0] = scales.scale_s_p2();
      if (scales.has_scale_t_p2()) muscle.scale_t[0] = scales.scale_t_p2();
      if (scales.has_scale_s_p4()) muscle.scale_s[1] = scales.scale_s_p4();
      if (scales.has_scale_t_p4()) muscle.scale_t[1] = scales.scale_t_p4();
      muscle.pivot_m = {scales.pivot_s_m(), scales.pivot_t_m()};
      return true;
    }
    case v1::Muscle::kPreserveVolume: {
      const v1::PreserveVolume& preserve = proto.preserve_volume();
      muscle.mode = MuscleMode::kPreserveVolume;
      if (preserve.has_min_scale()) muscle.min_scale = preserve.min_scale();
      if (preserve.has_max_scale()) muscle.max_scale = preserve.max_scale();
      return true;
    }
    case v1::Muscle::MODE_NOT_SET:
      return false;
  }
  return false;
}

void ModeToProto(const Muscle& muscle, v1::Muscle* proto) {
  switch (muscle.mode) {
    case MuscleMode::kDriven: {
      v1::DrivenMuscle* driven = proto->mutable_driven();
      driven->set_driver_joint_id(muscle.driver_joint_id);
      driven->set_gain_s(muscle.gain_s);
      driven->set_gain_t(muscle.gain_t);
      driven->set_pivot_s_m(muscle.pivot_m.x());
      driven->set_pivot_t_m(muscle.pivot_m.y());
      return;
    }
    case MuscleMode::kExplicit: {
      v1::ExplicitScales* scales = proto->mutable_explicit_scales();
      scales->set_scale_s_p2(muscle.scale_s[0]);
      scales->set_scale_t_p2(muscle.scale_t[0]);
      scales->set_scale_s_p4(muscle.scale_s[1]);
      scales->set_scale_t_p4(muscle.scale_t[1]);
      scales->set_pivot_s_m(muscle.pivot_m.x());
      scales->set_pivot_t_m(muscle.pivot_m.y());
      return;
    }
    case MuscleMode::kPreserveVolume: {
      v1::PreserveVolume* preserve = proto->mutable_preserve_volume();
      preserve->set_min_scale(muscle.min_scale);
      preserve->set_max_scale(muscle.max_scale);
      return;
    }
  }
}

}  // namespace

absl::StatusOr<SkinMuscles> FromProto(const MuscleList& muscles,
                                      const FullnessList& fullness) {
  Violations violations;
  SkinMuscles result;
  for (int i = 0; i < muscles.size(); ++i) {
    Muscle& muscle = result.muscles.emplace_back();
    muscle.id = muscles[i].muscle_id();
    muscle.link_id = muscles[i].link_id();
    if (!ModeFromProto(muscles[i], muscle)) {
      violations.Add(absl::StrCat("muscles[", i, "]"),
                     "want one of driven, explicit_scales and preserve_volume");
    }
  }
  for (const v1::JointFullness& joint : fullness) {
    result.fullness.push_back({joint.link_id(), joint.fullness()});
  }
  if (!violations.empty()) return violations.ToStatus();
  return result;
}

void ToProto(const SkinMuscles& muscles, MuscleList* muscles_proto,
             FullnessList* fullness_proto) {
  for (const Muscle& muscle : muscles.muscles) {
    v1::Muscle* out = muscles_proto->Add();
    out->set_muscle_id(muscle.id);
    out->set_link_id(muscle.link_id);
    ModeToProto(muscle, out);
  }
  for (const JointFullness& joint : muscles.fullness) {
    v1::JointFullness* out = fullness_proto->Add();
    out->set_link_id(joint.link_id);
    out->set_fullness(joint.fullness);
  }
}

}  // namespace gelenk::convert
