#include "server/rpc/skin_creation.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "gelenk/base/violations.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/skin_building.h"
#include "server/rpc/skin_message.h"

namespace gelenk::server {
namespace {

// The skeleton that the request names; null for a bundled shape, which brings
// its own.
absl::StatusOr<std::shared_ptr<const Skeleton>> SkeletonOf(
    const ServiceState& state, const v1::Skin& proto) {
  if (!proto.has_shape()) {
    absl::StatusOr<StoredSkeleton> stored =
        FindSkeleton(state, "skin.skeleton", proto.skeleton());
    if (!stored.ok()) return stored.status();
    return stored->skeleton;
  }
  if (proto.skeleton().empty()) return std::shared_ptr<const Skeleton>();
  Violations violations;
  violations.Add("skin.skeleton", "a bundled shape brings its own: want none");
  return violations.ToStatus();
}

// Keeps the skeleton that a shape brought; its name.
absl::StatusOr<std::string> KeepSkeleton(ServiceState& state,
                                         const v1::Skin& proto,
                                         const Skin& skin) {
  StoredSkeleton stored;
  stored.display_name = proto.shape().shape_id();
  stored.create_time = absl::Now();
  stored.skeleton = skin.shared_skeleton();
  absl::StatusOr<StoredSkeleton> created =
      state.skeletons.Create(kDefaultTenant, "", "", std::move(stored));
  if (!created.ok()) return created.status();
  return created->name;
}

absl::StatusOr<StoredSkin> Keep(ServiceState& state,
                                const v1::CreateSkinRequest& request,
                                const std::string& skeleton_name,
                                std::shared_ptr<const Skin> skin) {
  StoredSkin stored;
  stored.display_name = request.skin().display_name();
  stored.skeleton_name = skeleton_name;
  stored.create_time = absl::Now();
  stored.revision = MakeRevision(std::move(skin));
  return state.skins.Create(
      kDefaultTenant, request.skin_id(), request.request_id(),
      std::move(stored), [&state, &skeleton_name] {
        // It may have been deleted meanwhile.
        return state.skeletons.Find(kDefaultTenant, skeleton_name).status();
      });
}

}  // namespace

absl::Status CreateSkin(ServiceState& state,
                        const v1::CreateSkinRequest& request,
                        const std::function<bool()>& is_cancelled,
                        v1::Skin* response) {
  Violations violations;
  if (!request.skin_id().empty()) {
    violations.AddStatus("", CheckResourceId("skin_id", request.skin_id()));
  }
  violations.AddStatus("", CheckRequestId(request.request_id()));
  if (!violations.empty()) return violations.ToStatus();
  // Binding takes long: not twice.
  if (const std::optional<StoredSkin> earlier =
          state.skins.FindCreated(kDefaultTenant, request.request_id())) {
    ToProto(*earlier, response);
    return absl::OkStatus();
  }
  const v1::Skin& proto = request.skin();
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton =
      SkeletonOf(state, proto);
  if (!skeleton.ok()) return skeleton.status();
  absl::StatusOr<std::shared_ptr<const Skin>> skin =
      BuildSkin(*std::move(skeleton), proto, state.options.limits);
  if (absl::IsUnimplemented(skin.status())) return skin.status();
  violations.AddStatus("skin", skin.status());
  if (!violations.empty()) return violations.ToStatus();
  if (is_cancelled()) return absl::CancelledError("the client is gone");

  absl::StatusOr<std::string> skeleton_name = proto.skeleton();
  if (proto.has_shape()) {
    skeleton_name = KeepSkeleton(state, proto, **skin);
    if (!skeleton_name.ok()) return skeleton_name.status();
  }
  const absl::StatusOr<StoredSkin> created =
      Keep(state, request, *skeleton_name, *std::move(skin));
  if (proto.has_shape() &&
      (!created.ok() || created->skeleton_name != *skeleton_name)) {
    // Of a request that failed, or that somebody repeated meanwhile, nothing
    // stays.
    state.skeletons.Delete(kDefaultTenant, *skeleton_name).IgnoreError();
  }
  if (!created.ok()) return created.status();
  ToProto(*created, response);
  return absl::OkStatus();
}

}  // namespace gelenk::server
