#include "server/rpc/kinematics_service.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "convert/goal.h"
#include "convert/pose.h"
#include "convert/skeleton.h"
#include "convert/solver.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "server/rpc/batch_method.h"
#include "server/rpc/chain_methods.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/page.h"
#include "server/rpc/skeleton_message.h"
#include "server/rpc/skeleton_upload.h"
#include "server/rpc/unary_call.h"
#include "server/rpc/workspace_method.h"
#include "server/version.h"

namespace gelenk::server {
namespace {

using Service = v1::KinematicsService::AsyncService;

absl::Status CreateSkeleton(ServiceState& state,
                            const v1::CreateSkeletonRequest& request,
                            v1::Skeleton* response) {
  Violations violations;
  if (!request.skeleton_id().empty()) {
    violations.AddStatus("",
                         CheckResourceId("skeleton_id", request.skeleton_id()));
  }
  violations.AddStatus("", CheckRequestId(request.request_id()));
  SkeletonBounds bounds;
  bounds.max_joints = state.options.limits.max_joints;
  absl::StatusOr<std::shared_ptr<const Skeleton>> skeleton =
      convert::FromProto(request.skeleton(), bounds);
  violations.AddStatus("skeleton", skeleton.status());
  if (!violations.empty()) return violations.ToStatus();

  StoredSkeleton stored;
  stored.display_name = request.skeleton().display_name();
  // A planar chain is planar unless it says otherwise.
  stored.planar =
      request.skeleton().dimension() == v1::DIMENSION_PLANAR ||
      (request.skeleton().dimension() == v1::DIMENSION_UNSPECIFIED &&
       request.skeleton().has_planar_chain());
  stored.warnings.assign(request.skeleton().warnings().begin(),
                         request.skeleton().warnings().end());
  stored.create_time = absl::Now();
  stored.skeleton = *std::move(skeleton);
  absl::StatusOr<StoredSkeleton> created =
      state.skeletons.Create(kDefaultTenant, request.skeleton_id(),
                             request.request_id(), std::move(stored));
  if (!created.ok()) return created.status();
  ToProto(*created, response);
  return absl::OkStatus();
}

absl::Status GetSkeleton(const ServiceState& state,
                         const v1::GetSkeletonRequest& request,
                         v1::Skeleton* response) {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "name", request.name());
  if (!stored.ok()) return stored.status();
  ToProto(*stored, response);
  return absl::OkStatus();
}

absl::Status ListSkeletons(const ServiceState& state,
                           const v1::ListSkeletonsRequest& request,
                           v1::ListSkeletonsResponse* response) {
  absl::StatusOr<size_t> size = PageSize(request.page_size());
  if (!size.ok()) return size.status();
  std::vector<StoredSkeleton> page =
      state.skeletons.List(kDefaultTenant, request.page_token(), *size + 1);
  response->set_next_page_token(TakeNextPageToken(
      *size, page, [](const StoredSkeleton& stored) { return stored.name; }));
  for (const StoredSkeleton& stored : page) {
    ToListedProto(stored, response->add_skeletons());
  }
  return absl::OkStatus();
}

absl::Status DeleteSkeleton(ServiceState& state,
                            const v1::DeleteSkeletonRequest& request) {
  absl::Status status = CheckResourceName("name", kSkeletons, request.name());
  if (!status.ok()) return status;
  status = state.clips.RemoveUnused(kDefaultTenant, request.name(), [&] {
    return state.sessions.RemoveUnused(
        kDefaultTenant, request.name(), absl::Now(), [&] {
          return state.skins.RemoveUnused(kDefaultTenant, request.name(), [&] {
            return state.skeletons.Delete(kDefaultTenant, request.name());
          });
        });
  });
  if (request.allow_missing() && absl::IsNotFound(status)) {
    return absl::OkStatus();
  }
  return status;
}

absl::Status ComputeForwardKinematics(
    const ServiceState& state,
    const v1::ComputeForwardKinematicsRequest& request,
    v1::ComputeForwardKinematicsResponse* response) {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "skeleton", request.skeleton());
  if (!stored.ok()) return stored.status();
  Violations violations;
  const int most = state.options.limits.max_poses_per_call;
  if (request.poses_size() == 0 || request.poses_size() > most) {
    violations.Add("poses", absl::StrCat("want 1 to ", most, ", got ",
                                         request.poses_size()));
    return violations.ToStatus();
  }
  WorldTransforms frames;
  for (int i = 0; i < request.poses_size(); ++i) {
    absl::StatusOr<Eigen::VectorXd> positions =
        convert::FromProto(*stored->skeleton, request.poses(i));
    if (!positions.ok()) {
      violations.AddStatus(absl::StrCat("poses[", i, "]"), positions.status());
      continue;
    }
    ForwardKinematics(*stored->skeleton, *positions, frames);
    convert::ToProto(frames, response->add_joint_frames());
  }
  return violations.ToStatus();
}

absl::Status SolveInverseKinematics(
    const ServiceState& state, IkSolver& solver,
    const v1::SolveInverseKinematicsRequest& request,
    v1::SolveInverseKinematicsResponse* response) {
  absl::StatusOr<StoredSkeleton> stored =
      FindSkeleton(state, "skeleton", request.skeleton());
  if (!stored.ok()) return stored.status();
  const Skeleton& skeleton = *stored->skeleton;

  Violations violations;
  absl::StatusOr<std::vector<Goal>> goals =
      convert::FromProto(request.goals(), &skeleton);
  violations.AddStatus("", goals.status());
  absl::StatusOr<SolverOptions> options =
      convert::FromProto(request.solver_options());
  absl::StatusOr<IkProblem> problem =
      goals.ok() ? stored->trees->CreateProblem(
                       *std::move(goals), options.value_or(SolverOptions()))
                 : goals.status();
  if (goals.ok()) violations.AddStatus("", problem.status());
  violations.AddStatus("solver_options", options.status());
  absl::StatusOr<Eigen::VectorXd> positions = skeleton.rest_positions();
  if (request.has_start_pose()) {
    positions = convert::FromProto(skeleton, request.start_pose());
    violations.AddStatus("start_pose", positions.status());
  }
  if (!violations.empty()) return violations.ToStatus();

  SolveReport report;
  const absl::Time begin = absl::Now();
  solver.Solve(*problem, *options,
               request.has_start_pose() ? SolveStart::kWarm : SolveStart::kCold,
               *positions, report);
  convert::ToProto(report, options->detail, absl::Now() - begin,
                   response->mutable_report());
  convert::ToProto(*positions, response->mutable_pose());
  if (request.include_joint_frames()) {
    WorldTransforms frames;
    ForwardKinematics(skeleton, *positions, frames);
    convert::ToProto(frames, response->mutable_joint_frames());
  }
  return absl::OkStatus();
}

absl::Status GetServerInfo(const ServiceState& state,
                           v1::ServerInfo* response) {
  const Limits& limits = state.options.limits;
  response->set_version(Version());
  response->set_build(BuildId());
  response->set_instruction_set(
      std::string(InstructionSetName(state.options.instruction_set)));
  for (InstructionSet level : SupportedInstructionSets()) {
    response->add_supported_instruction_sets(
        std::string(InstructionSetName(level)));
  }
  response->set_max_sessions(limits.max_sessions);
  response->set_max_skeletons(limits.max_skeletons);
  response->set_max_joints(limits.max_joints);
  response->set_max_goals(kMaxGoals);
  response->set_max_message_bytes(limits.max_message_bytes);
  response->set_max_import_bytes(limits.max_import_bytes);
  response->set_max_clips(limits.max_clips);
  response->set_max_clip_bytes(static_cast<int64_t>(limits.max_clip_bytes));
  response->set_max_clip_numbers(limits.max_clip_numbers);
  response->set_max_clip_revisions(limits.max_clip_revisions);
  response->set_max_recording_bytes(limits.max_recording_bytes);
  response->set_max_skins(limits.max_skins);
  response->set_max_skin_bytes(static_cast<int64_t>(limits.max_skin_bytes));
  response->set_max_skin_vertices(limits.max_skin_vertices);
  response->set_max_skin_triangles(limits.max_skin_triangles);
  response->set_max_skin_revisions(limits.max_skin_revisions);
  return absl::OkStatus();
}

}  // namespace

void ServeKinematics(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestCreateSkeleton,
      [state](IkSolver&, const v1::CreateSkeletonRequest& request,
              v1::Skeleton* response) {
        return CreateSkeleton(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestGetSkeleton,
      [state](IkSolver&, const v1::GetSkeletonRequest& request,
              v1::Skeleton* response) {
        return GetSkeleton(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestListSkeletons,
      [state](IkSolver&, const v1::ListSkeletonsRequest& request,
              v1::ListSkeletonsResponse* response) {
        return ListSkeletons(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestDeleteSkeleton,
      [state](IkSolver&, const v1::DeleteSkeletonRequest& request,
              google::protobuf::Empty*) {
        return DeleteSkeleton(*state, request);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestComputeForwardKinematics,
      [state](IkSolver&, const v1::ComputeForwardKinematicsRequest& request,
              v1::ComputeForwardKinematicsResponse* response) {
        return ComputeForwardKinematics(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestSolveInverseKinematics,
      [state](IkSolver& solver,
              const v1::SolveInverseKinematicsRequest& request,
              v1::SolveInverseKinematicsResponse* response) {
        return SolveInverseKinematics(*state, solver, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestGetServerInfo,
      [state](IkSolver&, const v1::GetServerInfoRequest&,
              v1::ServerInfo* response) {
        return GetServerInfo(*state, response);
      },
      state, thread);
  ServeChains(service, state, thread);
  ServeBatch(service, state, thread);
  ServeWorkspace(service, state, thread);
  ServeSkeletonUploads(service, state, thread);
}

}  // namespace gelenk::server
