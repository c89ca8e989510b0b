#include "server/rpc/skin_message.h"

#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "convert/muscle.h"
#include "convert/skin_binding.h"
#include "convert/skin_deformer.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/nurbs_skin.h"
#include "gelenk/skin/weighted_skin.h"
#include "server/rpc/find_session.h"
#include "server/rpc/session_message.h"
#include "server/rpc/skin_building.h"

namespace gelenk::server {
namespace {

// Volumes that are inside out before anything bends.
void AddFolds(const VolumeRig& rig, v1::Skin* proto) {
  std::set<std::string> links;
  for (const VolumeFold& fold : rig.FindFolds(rig.rest())) {
    const SkinLink& link = rig.link(rig.volume_link(fold.volume));
    links.insert(rig.skeleton().joint(link.joint).id);
  }
  if (links.empty()) return;
  proto->add_warnings(absl::StrCat(
      "volumes fold in the bind pose already, within the sections of ",
      absl::StrJoin(links, ", ")));
}

void AddWarnings(const SkinRevision& revision, v1::Skin* proto) {
  const auto count = [&revision](BindingClass binding_class) {
    return revision.class_counts[static_cast<int>(binding_class)];
  };
  if (const int outside = count(BindingClass::kOutside); outside > 0) {
    proto->add_warnings(absl::StrCat(
        outside, " vertices lie in no volume: bound to the nearest link"));
  }
  if (revision.stretched_edge_count > 0) {
    proto->add_warnings(absl::StrCat(
        revision.stretched_edge_count,
        " edges run between links that are not neighbours: they will stretch"));
  }
  if (const VolumeRig* rig = RigOf(*revision.skin)) AddFolds(*rig, proto);
  const auto* nurbs = dynamic_cast<const NurbsSkin*>(revision.skin.get());
  if (nurbs != nullptr &&
      nurbs->estimated_error_m() > nurbs->options().tolerance_m) {
    proto->add_warnings(absl::StrFormat(
        "is off by %g m in a bend, the tolerance is %g m",
        nurbs->estimated_error_m(), nurbs->options().tolerance_m));
  }
}

// How the skin is deformed; weights stay here.
void AddDeformer(const Skin& skin, v1::Skin* proto) {
  if (const VolumeRig* rig = RigOf(skin)) {
    v1::LayeredVolumes* volumes = proto->mutable_layered_volumes();
    convert::ToProto(rig->muscles(), volumes->mutable_muscles(),
                     volumes->mutable_fullness());
    for (int i = 0; i < rig->link_count(); ++i) {
      convert::ToProto(*rig, i, proto->add_links());
    }
    return;
  }
  const auto* weighted = dynamic_cast<const WeightedSkin*>(&skin);
  if (weighted != nullptr && weighted->rigid_joint() >= 0) {
    proto->mutable_rigid_attachment()->set_joint_id(
        skin.skeleton().joint(weighted->rigid_joint()).id);
  } else if (weighted != nullptr &&
             weighted->method() == BlendMethod::kDualQuaternion) {
    proto->mutable_dual_quaternion();
  } else {
    proto->mutable_linear_blend();
  }
}

}  // namespace

void ToProto(const StoredSkin& stored, v1::Skin* proto) {
  const SkinRevision& revision = stored.revision;
  const Skin& skin = *revision.skin;
  proto->set_name(stored.name);
  proto->set_display_name(stored.display_name);
  proto->set_skeleton(stored.skeleton_name);
  proto->set_revision(revision.number);
  proto->set_base_revision(revision.base);
  proto->set_vertex_count(skin.vertex_count());
  proto->set_triangle_count(static_cast<int>(skin.triangles().size()));
  proto->set_block_count(skin.block_count());
  AddDeformer(skin, proto);
  if (AsLayered(skin) != nullptr) {
    convert::ToProto(revision.class_counts, proto->mutable_binding_counts());
  }
  if (const auto* nurbs = dynamic_cast<const NurbsSkin*>(&skin)) {
    proto->set_estimated_error_m(nurbs->estimated_error_m());
  }
  AddWarnings(revision, proto);
  proto->set_byte_size(static_cast<int64_t>(stored.byte_size));
  ToProto(stored.create_time, proto->mutable_create_time());
}

absl::StatusOr<StoredSkin> FindSkin(const ServiceState& state,
                                    absl::string_view field,
                                    const std::string& name) {
  absl::StatusOr<RevisionedName> parsed =
      ParseRevisionName(field, kSkins, name);
  if (!parsed.ok()) return parsed.status();
  return state.skins.Find(kDefaultTenant, parsed->name, parsed->revision);
}

absl::StatusOr<std::shared_ptr<Session>> FindSessionOf(
    const ServiceState& state, const StoredSkin& skin, absl::string_view field,
    const std::string& name) {
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSession(state, field, name);
  if (!session.ok()) return session.status();
  if ((*session)->skeleton_name() == skin.skeleton_name) return session;
  Violations violations;
  violations.Add(
      field, absl::StrCat(name, " is on ", (*session)->skeleton_name(), ", ",
                          skin.name, " on ", skin.skeleton_name));
  return violations.ToStatus();
}

}  // namespace gelenk::server
