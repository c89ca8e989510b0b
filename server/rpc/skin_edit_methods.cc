#include "server/rpc/skin_edit_methods.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/muscle.h"
#include "convert/skin_binding.h"
#include "convert/vertex_runs.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skin/nurbs_skin.h"
#include "gelenk/skin/rebind.h"
#include "server/rpc/skin_building.h"
#include "server/rpc/skin_message.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::SkinService::AsyncService;

// What an edit starts from.
struct EditBase {
  StoredSkin stored;
  // The newest revision there must still be when the edit is stored; unset
  // where an older one was asked for.
  std::optional<int64_t> expected;
  // What an earlier edit of that request_id made.
  std::optional<StoredSkin> repeated;
};

template <class Request>
absl::StatusOr<EditBase> BaseOf(ServiceState& state, const Request& request) {
  Violations violations;
  violations.AddStatus("", CheckRequestId(request.request_id()));
  absl::StatusOr<RevisionedName> name =
      ParseRevisionName("name", kSkins, request.name());
  violations.AddStatus("", name.status());
  if (!violations.empty()) return violations.ToStatus();
  EditBase base;
  base.repeated =
      state.skins.FindAdded(kDefaultTenant, name->name, request.request_id());
  // A repeat starts from where the first one did, if that is still there.
  if (base.repeated) name->revision = base.repeated->revision.base;
  absl::StatusOr<StoredSkin> stored =
      state.skins.Find(kDefaultTenant, name->name, name->revision);
  if (!stored.ok() && base.repeated) stored = *base.repeated;
  if (!stored.ok()) return stored.status();
  base.stored = *std::move(stored);
  if (!name->revision) base.expected = base.stored.revision.number;
  return base;
}

// Keeps `revision` on top.
absl::StatusOr<StoredSkin> Keep(ServiceState& state, const EditBase& base,
                                const std::string& request_id,
                                SkinRevision revision) {
  return state.skins.AddRevision(kDefaultTenant, base.stored.name, request_id,
                                 base.expected, std::move(revision));
}

// The same for a skin that was made from the base.
absl::StatusOr<StoredSkin> KeepEdit(ServiceState& state, const EditBase& base,
                                    const std::string& request_id,
                                    SkinRevision revision) {
  revision.base = base.stored.revision.number;
  return Keep(state, base, request_id, std::move(revision));
}

absl::StatusOr<const LayeredSkin*> NeedLayered(const StoredSkin& stored) {
  const LayeredSkin* layered = AsLayered(*stored.revision.skin);
  if (layered != nullptr) return layered;
  return absl::FailedPreconditionError(
      absl::StrCat("name: ", stored.name,
                   " is no mesh in layered volumes: there is no binding; "
                   "what has weights follows those it was created with"));
}

// `muscles` with what the request changes.
absl::StatusOr<SkinMuscles> Changed(const v1::UpdateMusclesRequest& request,
                                    SkinMuscles muscles) {
  Violations violations;
  for (int i = 0; i < request.removed_muscle_ids_size(); ++i) {
    const std::string& id = request.removed_muscle_ids(i);
    const auto has_gone =
        std::remove_if(muscles.muscles.begin(), muscles.muscles.end(),
                       [&id](const Muscle& muscle) { return muscle.id == id; });
    if (has_gone == muscles.muscles.end()) {
      violations.Add(absl::StrCat("removed_muscle_ids[", i, "]"),
                     absl::StrCat("no muscle ", QuotedId(id)));
    }
    muscles.muscles.erase(has_gone, muscles.muscles.end());
  }
  absl::StatusOr<SkinMuscles> told =
      convert::FromProto(request.muscles(), request.fullness());
  violations.AddStatus("", told.status());
  if (!violations.empty()) return violations.ToStatus();
  for (Muscle& muscle : told->muscles) {
    const auto same = std::find_if(
        muscles.muscles.begin(), muscles.muscles.end(),
        [&muscle](const Muscle& other) { return other.id == muscle.id; });
    if (same == muscles.muscles.end()) {
      muscles.muscles.push_back(std::move(muscle));
    } else {
      *same = std::move(muscle);
    }
  }
  for (const JointFullness& joint : told->fullness) {
    std::erase_if(muscles.fullness, [&joint](const JointFullness& other) {
      return other.link_id == joint.link_id;
    });
    muscles.fullness.push_back(joint);
  }
  return muscles;
}

absl::StatusOr<std::shared_ptr<const Skin>> WithMuscles(
    const Skin& skin, const SkinMuscles& muscles) {
  if (const LayeredSkin* layered = AsLayered(skin)) {
    return layered->WithMuscles(muscles);
  }
  return dynamic_cast<const NurbsSkin&>(skin).WithMuscles(muscles);
}

absl::Status UpdateMuscles(ServiceState& state,
                           const v1::UpdateMusclesRequest& request,
                           v1::Skin* response) {
  absl::StatusOr<EditBase> base = BaseOf(state, request);
  if (!base.ok()) return base.status();
  if (base->repeated) {
    ToProto(*base->repeated, response);
    return absl::OkStatus();
  }
  const VolumeRig* rig = RigOf(*base->stored.revision.skin);
  if (rig == nullptr) {
    return absl::FailedPreconditionError(absl::StrCat(
        "name: ", base->stored.name, " has no volumes for muscles to swell"));
  }
  absl::StatusOr<SkinMuscles> muscles = Changed(request, rig->muscles());
  if (!muscles.ok()) return muscles.status();
  absl::StatusOr<std::shared_ptr<const Skin>> skin =
      WithMuscles(*base->stored.revision.skin, *muscles);
  if (!skin.ok()) return skin.status();
  absl::StatusOr<StoredSkin> edited = KeepEdit(
      state, *base, request.request_id(), MakeRevision(*std::move(skin)));
  if (!edited.ok()) return edited.status();
  ToProto(*edited, response);
  return absl::OkStatus();
}

absl::Status GetBinding(const ServiceState& state,
                        const v1::GetBindingRequest& request,
                        v1::Binding* response) {
  absl::StatusOr<StoredSkin> stored = FindSkin(state, "name", request.name());
  if (!stored.ok()) return stored.status();
  absl::StatusOr<const LayeredSkin*> layered = NeedLayered(*stored);
  if (!layered.ok()) return layered.status();
  response->set_name(RevisionText(stored->name, stored->revision.number));
  convert::ToProto(**layered,
                   {request.include_classes(), request.include_candidates(),
                    request.include_vertex_links()},
                   response);
  return absl::OkStatus();
}

absl::StatusOr<RebindResult> RebindAsAsked(
    const LayeredSkin& skin, const v1::RebindVerticesRequest& request) {
  Violations violations;
  const absl::StatusOr<VertexSelector> selector =
      convert::FromProto(request.selector(), skin.vertex_count());
  violations.AddStatus("selector", selector.status());
  const absl::StatusOr<AssignmentScope> scope =
      convert::FromProto(request.scope());
  violations.AddStatus("", scope.status());
  if (!request.link_id().empty() &&
      skin.rig().FindLink(request.link_id()) < 0) {
    violations.Add("link_id",
                   absl::StrCat("no link ", QuotedId(request.link_id())));
  }
  if (!violations.empty()) return violations.ToStatus();
  absl::StatusOr<RebindResult> result =
      Rebind(skin.rig(), skin.mesh(), skin.binding(), *selector,
             request.link_id(), *scope);
  violations.AddStatus("selector", result.status());
  if (!violations.empty()) return violations.ToStatus();
  return result;
}

absl::Status RebindVertices(ServiceState& state,
                            const v1::RebindVerticesRequest& request,
                            v1::RebindVerticesResponse* response) {
  absl::StatusOr<EditBase> base = BaseOf(state, request);
  if (!base.ok()) return base.status();
  absl::StatusOr<const LayeredSkin*> layered = NeedLayered(base->stored);
  if (!layered.ok()) return layered.status();
  absl::StatusOr<RebindResult> result = RebindAsAsked(**layered, request);
  if (!result.ok()) return result.status();
  convert::ToProto(result->selected, response->mutable_selected());
  convert::ToProto(result->moved, response->mutable_moved());
  convert::ToProto(base->stored.revision.class_counts,
                   response->mutable_counts_before());

  // What is as it was makes no revision.
  const bool changes =
      result->binding.assignments != (*layered)->binding().assignments;
  const auto rig = (*layered)->shared_rig();
  absl::StatusOr<std::shared_ptr<const LayeredSkin>> skin = LayeredSkin::Create(
      rig, (*layered)->mesh(),
      std::make_shared<const SkinBinding>(std::move(result->binding)));
  if (!skin.ok()) return skin.status();
  SkinRevision revision = MakeRevision(*std::move(skin));
  convert::ToProto(revision.class_counts, response->mutable_counts());
  response->set_stretched_edge_count(revision.stretched_edge_count);
  if (request.dry_run() || !changes) {
    ToProto(base->stored, response->mutable_skin());
    return absl::OkStatus();
  }
  if (base->repeated) {
    ToProto(*base->repeated, response->mutable_skin());
    return absl::OkStatus();
  }
  absl::StatusOr<StoredSkin> edited =
      KeepEdit(state, *base, request.request_id(), std::move(revision));
  if (!edited.ok()) return edited.status();
  ToProto(*edited, response->mutable_skin());
  return absl::OkStatus();
}

absl::Status RollbackSkin(ServiceState& state,
                          const v1::RollbackSkinRequest& request,
                          v1::Skin* response) {
  absl::StatusOr<EditBase> base = BaseOf(state, request);
  if (!base.ok()) return base.status();
  if (base->repeated) {
    ToProto(*base->repeated, response);
    return absl::OkStatus();
  }
  if (base->expected) {
    Violations violations;
    violations.Add("name", absl::StrCat("want ", base->stored.name,
                                        "@{revision} to go back to"));
    return violations.ToStatus();
  }
  // Its base is that of what it restores, so that undo goes on from there.
  absl::StatusOr<StoredSkin> restored =
      Keep(state, *base, request.request_id(), base->stored.revision);
  if (!restored.ok()) return restored.status();
  ToProto(*restored, response);
  return absl::OkStatus();
}

}  // namespace

void ServeSkinEdits(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestUpdateMuscles,
      [state](IkSolver&, const v1::UpdateMusclesRequest& request,
              v1::Skin* response) {
        return UpdateMuscles(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestGetBinding,
      [state](IkSolver&, const v1::GetBindingRequest& request,
              v1::Binding* response) {
        return GetBinding(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestRebindVertices,
      [state](IkSolver&, const v1::RebindVerticesRequest& request,
              v1::RebindVerticesResponse* response) {
        return RebindVertices(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestRollbackSkin,
      [state](IkSolver&, const v1::RollbackSkinRequest& request,
              v1::Skin* response) {
        return RollbackSkin(*state, request, response);
      },
      state, thread);
}

}  // namespace gelenk::server
