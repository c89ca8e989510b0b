#include "server/rpc/session_service.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "convert/duration.h"
#include "convert/goal.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "server/rpc/find_session.h"
#include "server/rpc/input_message.h"
#include "server/rpc/page.h"
#include "server/rpc/session_message.h"
#include "server/rpc/streaming_solve_call.h"
#include "server/rpc/unary_call.h"
#include "server/rpc/watch_session_call.h"

namespace gelenk::server {
namespace {

using Service = v1::SessionService::AsyncService;

// Keys travel as a header, so they must be visible ASCII.
constexpr size_t kMaxAffinityKeyBytes = 128;

absl::Status CheckAffinityKey(absl::string_view key) {
  bool visible = key.size() <= kMaxAffinityKeyBytes;
  for (char c : key) visible = visible && c > ' ' && c <= '~';
  if (visible) return absl::OkStatus();
  Violations violations;
  violations.Add("session.affinity_key",
                 absl::StrCat("want at most ", kMaxAffinityKeyBytes,
                              " visible ASCII characters"));
  return violations.ToStatus();
}

// Makes the problem that a session of `parts`, read with `status`, would solve;
// adds every violation. Whether the method fits is asked once all else is
// right.
absl::StatusOr<IkProblem> MakeProblem(const absl::Status& status,
                                      const SessionState& parts,
                                      SharedTrees& trees,
                                      Violations& violations) {
  absl::StatusOr<IkProblem> problem = trees.CreateProblem(
      parts.goals, status.ok() ? parts.options : SolverOptions());
  violations.AddStatus("session", problem.status());
  return problem;
}

// Reads what the session of `proto` shall be; otherwise as above.
absl::StatusOr<IkProblem> ReadParts(const v1::Session& proto,
                                    const StoredSkeleton& skeleton,
                                    const Limits& limits, SessionState& parts,
                                    Violations& violations) {
  const absl::Status status =
      StateFromProto(proto, *skeleton.skeleton, limits, parts);
  violations.AddStatus("session", status);
  return MakeProblem(status, parts, *skeleton.trees, violations);
}

// What moves the session of `proto`; adds its violations.
absl::StatusOr<SessionInput> ReadInput(const ServiceState& state,
                                       const v1::Session& proto,
                                       const StoredSkeleton& skeleton,
                                       const SessionState& parts,
                                       Violations& violations) {
  absl::StatusOr<SessionInput> input =
      InputFromProto(state, proto, skeleton.skeleton, parts.goals);
  if (absl::IsInvalidArgument(input.status())) {
    violations.AddStatus("session", input.status());
  }
  return input;
}

// OK while the skeletons of the session of `proto` are there.
absl::Status CheckSkeletons(const ServiceState& state,
                            const v1::Session& proto) {
  for (const std::string& name :
       {proto.skeleton(), proto.retargeting().source_skeleton()}) {
    if (name.empty()) continue;
    const absl::Status found =
        state.skeletons.Find(kDefaultTenant, name).status();
    if (!found.ok()) return found;
  }
  return absl::OkStatus();
}

absl::Status CreateSession(ServiceState& state,
                           const v1::CreateSessionRequest& request,
                           v1::Session* response) {
  if (state.draining) {
    return absl::UnavailableError("the server is going away");
  }
  const v1::Session& proto = request.session();
  Violations violations;
  if (!request.session_id().empty()) {
    violations.AddStatus("",
                         CheckResourceId("session_id", request.session_id()));
  }
  violations.AddStatus("", CheckRequestId(request.request_id()));
  violations.AddStatus(
      "", CheckResourceName("session.skeleton", kSkeletons, proto.skeleton()));
  violations.AddStatus("", CheckAffinityKey(proto.affinity_key()));
  const absl::StatusOr<StoredSkeleton> skeleton =
      state.skeletons.Find(kDefaultTenant, proto.skeleton());
  SessionState parts;
  absl::StatusOr<IkProblem> problem =
      skeleton.ok()
          ? ReadParts(proto, *skeleton, state.options.limits, parts, violations)
          : skeleton.status();
  absl::StatusOr<SessionInput> input =
      skeleton.ok() ? ReadInput(state, proto, *skeleton, parts, violations)
                    : skeleton.status();
  if (!violations.empty()) return violations.ToStatus();
  if (!problem.ok()) return problem.status();
  if (!input.ok()) return input.status();

  const absl::Time now = absl::Now();
  absl::StatusOr<std::shared_ptr<Session>> session = state.sessions.Create(
      kDefaultTenant, request.session_id(), request.request_id(), now,
      [&](std::string name) -> absl::StatusOr<std::shared_ptr<Session>> {
        // They may have been deleted meanwhile.
        const absl::Status found = CheckSkeletons(state, proto);
        if (!found.ok()) return found;
        const std::string affinity_key = proto.affinity_key().empty()
                                             ? name.substr(kSessions.size() + 1)
                                             : proto.affinity_key();
        return std::make_shared<Session>(
            std::move(name), proto.skeleton(), affinity_key, skeleton->trees,
            *std::move(problem), std::move(parts), now, *std::move(input));
      });
  if (!session.ok()) return session.status();
  ToProto(**session, state.draining, response);
  return absl::OkStatus();
}

absl::Status GetSession(const ServiceState& state,
                        const v1::GetSessionRequest& request,
                        v1::Session* response) {
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSession(state, "name", request.name());
  if (!session.ok()) return session.status();
  ToProto(**session, state.draining, response);
  return absl::OkStatus();
}

absl::Status ListSessions(const ServiceState& state,
                          const v1::ListSessionsRequest& request,
                          v1::ListSessionsResponse* response) {
  absl::StatusOr<size_t> size = PageSize(request.page_size());
  if (!size.ok()) return size.status();
  std::vector<std::shared_ptr<Session>> page = state.sessions.List(
      kDefaultTenant, request.page_token(), *size + 1, absl::Now());
  response->set_next_page_token(TakeNextPageToken(
      *size, page, [](const auto& session) { return session->name(); }));
  for (const std::shared_ptr<Session>& session : page) {
    ToProto(*session, state.draining, response->add_sessions());
  }
  return absl::OkStatus();
}

absl::Status UpdateSession(const ServiceState& state,
                           const v1::UpdateSessionRequest& request,
                           v1::Session* response) {
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSession(state, "session.name", request.session().name());
  if (!session.ok()) return session.status();
  absl::StatusOr<std::optional<int64_t>> revision =
      RevisionOf(request.session().etag());
  if (!revision.ok()) return revision.status();
  absl::Status status = (*session)->Update(
      [&](SessionState& parts) {
        Violations violations;
        const absl::Status read = UpdateState(request, (*session)->skeleton(),
                                              state.options.limits, parts);
        violations.AddStatus("", read);
        // Made once more by Update; only here it is known what it is part of.
        MakeProblem(read, parts, (*session)->trees(), violations).IgnoreError();
        return violations.ToStatus();
      },
      *revision, absl::Now());
  if (!status.ok()) return status;
  ToProto(**session, state.draining, response);
  return absl::OkStatus();
}

absl::Status DeleteSession(ServiceState& state,
                           const v1::DeleteSessionRequest& request) {
  absl::Status status = CheckResourceName("name", kSessions, request.name());
  if (!status.ok()) return status;
  status = state.sessions.Delete(kDefaultTenant, request.name());
  if (request.allow_missing() && absl::IsNotFound(status)) {
    return absl::OkStatus();
  }
  return status;
}

absl::Status SolveSession(const ServiceState& state, IkSolver& solver,
                          const v1::SolveSessionRequest& request,
                          v1::SolveSessionResponse* response) {
  absl::StatusOr<std::shared_ptr<Session>> session =
      FindSession(state, "name", request.name());
  if (!session.ok()) return session.status();
  InputFrame frame;
  if (request.has_goal_patch()) {
    frame.patch = [&](absl::Span<const Goal> goals) {
      return convert::Merge(goals, request.goal_patch());
    };
  }
  if (request.has_source_pose()) {
    convert::CopyNumbers(request.source_pose(), frame.source_pose);
    frame.has_source_pose = true;
  }
  if (request.has_capture_time()) {
    frame.capture_time = convert::FromProto(request.capture_time());
  }
  if (absl::Status status = (*session)->Apply(kUnaryDriver, frame, absl::Now());
      !status.ok()) {
    return status;
  }
  SolvedFrame solved;
  if (absl::Status status =
          (*session)->Solve(kUnaryDriver, solver, true, solved);
      !status.ok()) {
    return status;
  }
  convert::ToProto(solved.positions, response->mutable_pose());
  ReportsToProto(solved, /*whole=*/true, response);
  if (request.include_joint_frames()) {
    WorldTransforms frames;
    ForwardKinematics((*session)->skeleton(), solved.positions,
                      (*session)->Snapshot().state.world_from_skeleton, frames);
    convert::ToProto(frames, response->mutable_joint_frames());
  }
  return absl::OkStatus();
}

}  // namespace

void ServeSessions(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestCreateSession,
      [state](IkSolver&, const v1::CreateSessionRequest& request,
              v1::Session* response) {
        return CreateSession(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestGetSession,
      [state](IkSolver&, const v1::GetSessionRequest& request,
              v1::Session* response) {
        return GetSession(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestListSessions,
      [state](IkSolver&, const v1::ListSessionsRequest& request,
              v1::ListSessionsResponse* response) {
        return ListSessions(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestUpdateSession,
      [state](IkSolver&, const v1::UpdateSessionRequest& request,
              v1::Session* response) {
        return UpdateSession(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestDeleteSession,
      [state](IkSolver&, const v1::DeleteSessionRequest& request,
              google::protobuf::Empty*) {
        return DeleteSession(*state, request);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestSolveSession,
      [state](IkSolver& solver, const v1::SolveSessionRequest& request,
              v1::SolveSessionResponse* response) {
        return SolveSession(*state, solver, request, response);
      },
      state, thread);
  StreamingSolveCall::Start(service, state, thread);
  WatchSessionCall::Start(service, state, thread);
}

}  // namespace gelenk::server
