#include "server/rpc/workspace_call.h"

#include <chrono>
#include <optional>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/workspace/planar_annulus.h"
#include "gelenk/workspace/workspace_map.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/status.h"

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

}  // namespace

void WorkspaceCall::Start(v1::KinematicsService::AsyncService* service,
                          ServiceState* state, IoThread* thread) {
  new WorkspaceCall(service, state, thread);
}

WorkspaceCall::WorkspaceCall(v1::KinematicsService::AsyncService* service,
                             ServiceState* state, IoThread* thread)
    : service_(service), state_(state), thread_(thread), count_(*thread) {
  grpc::ServerCompletionQueue* queue = thread_->queue();
  service_->RequestComputeWorkspace(&context_, &request_, &writer_, queue,
                                    queue, started_.tag());
}

void WorkspaceCall::OnStarted(bool ok) {
  if (!ok) {  // the server is shutting down
    delete this;
    return;
  }
  Start(service_, state_, thread_);
  const bool taken = state_->workers.Submit([this](IkSolver&) {
    status_ = Compute();
    alarm_.Set(thread_->queue(), std::chrono::system_clock::now(),
               computed_.tag());
  });
  if (taken) return;
  status_ = absl::ResourceExhaustedError("too many calls are waiting");
  writer_.Finish(ToGrpc(status_), finished_.tag());
}

absl::Status WorkspaceCall::Compute() {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(*state_, "skeleton", request_.skeleton());
  if (!stored.ok()) return stored.status();
  const Skeleton& skeleton = *stored->skeleton;
  if (!skeleton.FindEffector(request_.end_effector_id())) {
    Violations violations;
    violations.Add("end_effector_id",
                   absl::StrCat("no end effector or joint ",
                                QuotedId(request_.end_effector_id())));
    return violations.ToStatus();
  }
  if (!request_.sampled()) {
    if (const std::optional<PlanarAnnulus> annulus =
            ReachOf(skeleton, request_.end_effector_id())) {
      ToProto(*annulus, parts_.emplace_back().mutable_annulus());
      return absl::OkStatus();
    }
  }
  WorkspaceOptions options;
  if (request_.sample_count() != 0) {
    options.sample_count = request_.sample_count();
  }
  options.seed = request_.seed();
  options.voxel_size_m = request_.voxel_size_m();
  const absl::StatusOr<WorkspaceMap> map =
      MapWorkspace(skeleton, request_.end_effector_id(), options);
  if (!map.ok()) return map.status();
  ToProto(*map, parts_.emplace_back().mutable_grid());
  for (size_t i = 0; i < map->voxels.size(); ++i) {
    if (i % kVoxelsPerPart == 0) parts_.emplace_back();
    AddVoxel(map->voxels[i], parts_.back().mutable_voxels());
  }
  return absl::OkStatus();
}

void WorkspaceCall::OnComputed(bool) { WriteNext(); }

void WorkspaceCall::OnWritten(bool ok) {
  // Who has gone gets no more.
  if (!ok) next_ = parts_.size();
  WriteNext();
}

void WorkspaceCall::WriteNext() {
  if (status_.ok() && next_ < parts_.size()) {
    writer_.Write(parts_[next_++], written_.tag());
  } else {
    writer_.Finish(ToGrpc(status_), finished_.tag());
  }
}

void WorkspaceCall::OnFinished(bool) { delete this; }

}  // namespace gelenk::server
