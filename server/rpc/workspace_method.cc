#include "server/rpc/workspace_method.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/workspace/planar_annulus.h"
#include "gelenk/workspace/workspace_map.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/production_call.h"

namespace gelenk::server {
namespace {

// Voxels of one message: some 100 KB.
constexpr size_t kVoxelsPerPart = 8192;

void ToProto(const PlanarAnnulus& annulus, v1::PlanarAnnulus* proto) {
  convert::ToProto(annulus.world_center, proto->mutable_world_center());
  proto->set_inner_radius_m(annulus.inner_radius_m);
  proto->set_outer_radius_m(annulus.outer_radius_m);
  convert::ToProto(annulus.world_normal, proto->mutable_world_normal());
}

void ToProto(const WorkspaceMap& map, v1::VoxelGrid* proto) {
  convert::ToProto(map.world_min, proto->mutable_world_min());
  proto->set_voxel_size_m(map.voxel_size_m);
  proto->set_size_x(map.size.x());
  proto->set_size_y(map.size.y());
  proto->set_size_z(map.size.z());
  proto->set_reached_count(static_cast<int>(map.voxels.size()));
  proto->set_sample_count(map.sample_count);
}

void AddVoxel(const ReachedVoxel& voxel, v1::Voxels* proto) {
  proto->add_indices(voxel.index);
  proto->add_reach_counts(voxel.reach_count);
  proto->add_mean_manipulabilities(
      static_cast<float>(voxel.mean_manipulability));
}

using Parts = std::vector<v1::ComputeWorkspaceResponse>;

absl::StatusOr<Parts> Compute(const ServiceState& state,
                              const v1::ComputeWorkspaceRequest& request) {
  Parts parts;
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "skeleton", request.skeleton());
  if (!stored.ok()) return stored.status();
  const Skeleton& skeleton = *stored->skeleton;
  if (!skeleton.FindEffector(request.end_effector_id())) {
    Violations violations;
    violations.Add("end_effector_id",
                   absl::StrCat("no end effector or joint ",
                                QuotedId(request.end_effector_id())));
    return violations.ToStatus();
  }
  if (!request.sampled()) {
    if (const std::optional<PlanarAnnulus> annulus =
            ReachOf(skeleton, request.end_effector_id())) {
      ToProto(*annulus, parts.emplace_back().mutable_annulus());
      return parts;
    }
  }
  WorkspaceOptions options;
  if (request.sample_count() != 0) {
    options.sample_count = request.sample_count();
  }
  options.seed = request.seed();
  options.voxel_size_m = request.voxel_size_m();
  const absl::StatusOr<WorkspaceMap> map =
      MapWorkspace(skeleton, request.end_effector_id(), options);
  if (!map.ok()) return map.status();
  ToProto(*map, parts.emplace_back().mutable_grid());
  for (size_t i = 0; i < map->voxels.size(); ++i) {
    if (i % kVoxelsPerPart == 0) parts.emplace_back();
    AddVoxel(map->voxels[i], parts.back().mutable_voxels());
  }
  return parts;
}

class WorkspaceProduction final
    : public Production<v1::ComputeWorkspaceResponse> {
 public:
  explicit WorkspaceProduction(Parts parts) : parts_(std::move(parts)) {}

  absl::StatusOr<bool> Next(IkSolver&,
                            v1::ComputeWorkspaceResponse* response) override {
    if (next_ == parts_.size()) return false;
    *response = std::move(parts_[next_++]);
    return true;
  }

 private:
  Parts parts_;
  size_t next_ = 0;
};

}  // namespace

void ServeWorkspace(v1::KinematicsService::AsyncService* service,
                    ServiceState* state, IoThread* thread) {
  using Opened =
      absl::StatusOr<std::unique_ptr<Production<v1::ComputeWorkspaceResponse>>>;
  ServeProduction(
      service, &v1::KinematicsService::AsyncService::RequestComputeWorkspace,
      [state](const v1::ComputeWorkspaceRequest& request) -> Opened {
        absl::StatusOr<Parts> parts = Compute(*state, request);
        if (!parts.ok()) return parts.status();
        return std::make_unique<WorkspaceProduction>(*std::move(parts));
      },
      state, thread);
}

}  // namespace gelenk::server
