#include "tests/testing/fake_session_server.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "convert/goal.h"
#include "gelenk/internal/v1/continuation.pb.h"

namespace gelenk::testing {
namespace {

grpc::Status ToGrpc(const absl::Status& status) {
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()),
                      std::string(status.message()));
}

void SetStatus(const absl::Status& status, v1::FrameStatus* proto) {
  proto->set_code(static_cast<int>(status.code()));
  proto->set_message(std::string(status.message()));
}

v1::StreamEvent Event(v1::StreamEvent::Kind kind, int slot,
                      const absl::Status& status = absl::OkStatus()) {
  v1::StreamEvent event;
  event.set_kind(kind);
  event.set_slot(slot);
  if (!status.ok()) SetStatus(status, event.mutable_status());
  return event;
}

bool IsFinite(const GoalTarget& target) {
  const auto* point = std::get_if<Eigen::Vector3d>(&target);
  return point == nullptr || point->allFinite();
}

double Digest(const GoalTarget& target) {
  struct Sum {
    double operator()(const Eigen::Vector3d& point) const {
      return point.x() + 3 * point.y() + 7 * point.z();
    }
    double operator()(const Eigen::Quaterniond& rotation) const {
      return rotation.x() + 3 * rotation.y() + 7 * rotation.z() +
             11 * rotation.w();
    }
    double operator()(const RigidTransform& pose) const {
      return (*this)(pose.translation) + 13 * (*this)(pose.rotation);
    }
    double operator()(const Plane& plane) const {
      return (*this)(plane.world_normal) + 13 * plane.offset_m;
    }
    double operator()(const Eigen::VectorXd& positions) const {
      return positions.sum();
    }
    double operator()(std::monostate) const { return 0; }
  };
  return std::visit(Sum(), target);
}

// One number of everything that a frame may change.
double Digest(const std::vector<Goal>& goals,
              const RigidTransform& world_from_skeleton) {
  double digest = Digest(GoalTarget(world_from_skeleton));
  for (size_t i = 0; i < goals.size(); ++i) {
    digest += static_cast<double>(i + 1) * goals[i].weight *
              Digest(TargetOf(goals[i].kind));
  }
  return digest;
}

std::string Continuation(const std::vector<Goal>& goals,
                         const RigidTransform& world_from_skeleton) {
  internal::v1::SessionContinuation continuation;
  convert::ToProto(goals, continuation.mutable_goals());
  convert::ToProto(world_from_skeleton,
                   continuation.mutable_world_from_skeleton());
  return continuation.SerializeAsString();
}

}  // namespace

FakeSessionServer::FakeSessionServer() { Start(); }

FakeSessionServer::~FakeSessionServer() { Stop(); }

std::string FakeSessionServer::target() const {
  return absl::StrCat("127.0.0.1:", port_);
}

void FakeSessionServer::Stop() {
  if (server_ == nullptr) return;
  server_->Shutdown(std::chrono::system_clock::now());
  server_->Wait();
  server_.reset();
  std::lock_guard<std::mutex> lock(mutex_);
  skeletons_.clear();
  sessions_.clear();
  request_ids_.clear();
}

void FakeSessionServer::Start() {
  grpc::ServerBuilder builder;
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddListeningPort(target(), grpc::InsecureServerCredentials(), &port_);
  builder.RegisterService(static_cast<v1::KinematicsService::Service*>(this));
  builder.RegisterService(static_cast<v1::SessionService::Service*>(this));
  server_ = builder.BuildAndStart();
  if (server_ == nullptr) std::abort();
}

void FakeSessionServer::SetScript(Script script) {
  std::lock_guard<std::mutex> lock(mutex_);
  script_ = std::move(script);
}

void FakeSessionServer::SetContinues(bool continues) {
  std::lock_guard<std::mutex> lock(mutex_);
  continues_ = continues;
}

void FakeSessionServer::RefuseAttaches(int count, const absl::Status& status) {
  std::lock_guard<std::mutex> lock(mutex_);
  attach_refusals_ = {count, status};
}

void FakeSessionServer::RefuseCalls(int count, const absl::Status& status) {
  std::lock_guard<std::mutex> lock(mutex_);
  call_refusals_ = {count, status};
}

void FakeSessionServer::ForgetSession(const std::string& name) {
  std::lock_guard<std::mutex> lock(mutex_);
  sessions_.erase(name);
}

int FakeSessionServer::attach_count() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return static_cast<int>(attaches_.size());
}

std::vector<v1::AttachSession> FakeSessionServer::attaches() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return attaches_;
}

std::vector<v1::CreateSessionRequest> FakeSessionServer::creates() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return creates_;
}

int FakeSessionServer::delete_count() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return delete_count_;
}

std::vector<v1::TargetFrame> FakeSessionServer::frames() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return frames_;
}

std::vector<std::string> FakeSessionServer::affinity_keys() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return affinity_keys_;
}

grpc::Status FakeSessionServer::Refuse(Refusals* refusals) {
  if (refusals->count == 0) return grpc::Status::OK;
  --refusals->count;
  return ToGrpc(refusals->status);
}

grpc::Status FakeSessionServer::CreateSkeleton(
    grpc::ServerContext*, const v1::CreateSkeletonRequest* request,
    v1::Skeleton* response) {
  std::lock_guard<std::mutex> lock(mutex_);
  const grpc::Status refused = Refuse(&call_refusals_);
  if (!refused.ok()) return refused;
  const std::string name = absl::StrCat("skeletons/", request->skeleton_id());
  if (request_ids_.insert("skeleton " + request->request_id()).second) {
    if (skeletons_.count(name) > 0) {
      return ToGrpc(absl::AlreadyExistsError(name));
    }
    skeletons_[name] = request->skeleton();
    skeletons_[name].set_name(name);
  }
  *response = skeletons_[name];
  return grpc::Status::OK;
}

grpc::Status FakeSessionServer::GetSkeleton(
    grpc::ServerContext*, const v1::GetSkeletonRequest* request,
    v1::Skeleton* response) {
  std::lock_guard<std::mutex> lock(mutex_);
  const auto found = skeletons_.find(request->name());
  if (found == skeletons_.end()) {
    return ToGrpc(absl::NotFoundError(request->name()));
  }
  *response = found->second;
  return grpc::Status::OK;
}

grpc::Status FakeSessionServer::CreateSession(
    grpc::ServerContext*, const v1::CreateSessionRequest* request,
    v1::Session* response) {
  std::lock_guard<std::mutex> lock(mutex_);
  const grpc::Status refused = Refuse(&call_refusals_);
  if (!refused.ok()) return refused;
  creates_.push_back(*request);
  const std::string name = absl::StrCat("sessions/", request->session_id());
  *response = request->session();
  response->set_name(name);
  if (!request_ids_.insert("session " + request->request_id()).second) {
    return grpc::Status::OK;  // the first result
  }
  if (skeletons_.count(request->session().skeleton()) == 0) {
    return ToGrpc(absl::NotFoundError(request->session().skeleton()));
  }
  if (sessions_.count(name) > 0) return ToGrpc(absl::AlreadyExistsError(name));
  absl::StatusOr<std::vector<Goal>> goals =
      convert::FromProto(request->session().goals(), nullptr);
  if (!goals.ok()) return ToGrpc(goals.status());
  FakeSession session;
  session.declared = *response;
  session.goals = *std::move(goals);
  session.world_from_skeleton =
      convert::FromProto(request->session().world_from_skeleton());
  session.is_cold = !request->session().has_pose();
  const auto& positions = request->session().pose().positions();
  session.positions.assign(positions.begin(), positions.end());
  if (session.is_cold) session.positions = {0, 0};
  sessions_[name] = std::move(session);
  return grpc::Status::OK;
}

grpc::Status FakeSessionServer::GetSession(grpc::ServerContext*,
                                           const v1::GetSessionRequest* request,
                                           v1::Session* response) {
  std::lock_guard<std::mutex> lock(mutex_);
  const auto found = sessions_.find(request->name());
  if (found == sessions_.end()) {
    return ToGrpc(absl::NotFoundError(request->name()));
  }
  const FakeSession& session = found->second;
  *response = session.declared;
  convert::ToProto(session.goals, response->mutable_goals());
  convert::ToProto(session.world_from_skeleton,
                   response->mutable_world_from_skeleton());
  if (session.is_cold) return grpc::Status::OK;
  *response->mutable_pose()->mutable_positions() = {session.positions.begin(),
                                                    session.positions.end()};
  return grpc::Status::OK;
}

grpc::Status FakeSessionServer::DeleteSession(
    grpc::ServerContext*, const v1::DeleteSessionRequest* request,
    google::protobuf::Empty*) {
  std::lock_guard<std::mutex> lock(mutex_);
  ++delete_count_;
  const bool existed = sessions_.erase(request->name()) > 0;
  if (!existed && !request->allow_missing()) {
    return ToGrpc(absl::NotFoundError(request->name()));
  }
  return grpc::Status::OK;
}

v1::StreamEvent FakeSessionServer::Attach(const v1::AttachSession& attach,
                                          std::map<int, std::string>* slots) {
  std::lock_guard<std::mutex> lock(mutex_);
  attaches_.push_back(attach);
  if (attach_refusals_.count > 0) {
    --attach_refusals_.count;
    return Event(v1::StreamEvent::KIND_DETACHED, attach.slot(),
                 attach_refusals_.status);
  }
  const auto found = sessions_.find(attach.session());
  if (found == sessions_.end()) {
    return Event(v1::StreamEvent::KIND_DETACHED, attach.slot(),
                 absl::NotFoundError(attach.session()));
  }
  FakeSession& session = found->second;
  if (attach.has_resume_from()) {
    const v1::PoseFrame& resume = attach.resume_from();
    const auto& positions = resume.pose().positions();
    session.positions.assign(positions.begin(), positions.end());
    session.is_cold = false;
    session.sequence_number = resume.sequence_number();
    internal::v1::SessionContinuation continuation;
    if (!resume.continuation().empty() &&
        continuation.ParseFromString(resume.continuation())) {
      session.goals = *convert::FromProto(continuation.goals(), nullptr);
      session.world_from_skeleton =
          convert::FromProto(continuation.world_from_skeleton());
    }
  }
  (*slots)[attach.slot()] = attach.session();
  v1::StreamEvent event = Event(v1::StreamEvent::KIND_ATTACHED, attach.slot());
  event.set_sequence_number(session.sequence_number);
  return event;
}

absl::Status FakeSessionServer::Apply(const v1::TargetFrame& frame,
                                      FakeSession* session) {
  absl::StatusOr<std::vector<Goal>> goals =
      convert::Merge(session->goals, frame.goal_patch());
  if (!goals.ok()) return goals.status();
  for (const v1::GoalTarget& proto : frame.targets()) {
    const int index = proto.goal_index();
    const bool is_weight_alone =
        proto.target_case() == v1::GoalTarget::TARGET_NOT_SET;
    if (is_weight_alone && proto.has_weight() && index >= 0 &&
        index < static_cast<int>(goals->size())) {
      (*goals)[index].weight = proto.weight();
      continue;
    }
    GoalTarget target;
    const absl::Status converted = convert::FromProto(proto, &target);
    if (!converted.ok()) return converted;
    if (index < 0 || index >= static_cast<int>(goals->size()) ||
        !Fits((*goals)[index].kind, target) || !IsFinite(target)) {
      return absl::InvalidArgumentError(absl::StrCat("target of goal ", index));
    }
    Retarget((*goals)[index].kind, target);
    if (proto.has_weight()) (*goals)[index].weight = proto.weight();
  }
  session->goals = *std::move(goals);
  if (frame.has_world_from_skeleton()) {
    session->world_from_skeleton =
        convert::FromProto(frame.world_from_skeleton());
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::PoseFrame> FakeSessionServer::Solve(
    const std::string& name, const v1::TargetFrame& frame) {
  std::lock_guard<std::mutex> lock(mutex_);
  frames_.push_back(frame);
  const auto found = sessions_.find(name);
  if (found == sessions_.end()) return absl::NotFoundError(name);
  FakeSession& session = found->second;
  v1::PoseFrame answer;
  answer.set_slot(frame.slot());
  answer.set_sequence_number(frame.sequence_number());
  *answer.mutable_capture_time() = frame.capture_time();
  absl::Status status;
  if (frame.sequence_number() <= session.sequence_number) {
    status = absl::InvalidArgumentError("sequence_number: too old");
  } else {
    session.sequence_number = frame.sequence_number();
    status = Apply(frame, &session);
  }
  if (status.ok()) {
    const double digest = Digest(session.goals, session.world_from_skeleton);
    const double start = session.is_cold ? 100 : session.positions[0];
    session.positions = {std::sin(0.9 * start + digest),
                         session.positions[1] + 1};
    session.is_cold = false;
  } else {
    SetStatus(status, answer.mutable_status());
  }
  *answer.mutable_pose()->mutable_positions() = {session.positions.begin(),
                                                 session.positions.end()};
  if (continues_ && status.ok()) {
    answer.set_continuation(
        Continuation(session.goals, session.world_from_skeleton));
  }
  return answer;
}

Fate FakeSessionServer::FateOf(const v1::TargetFrame& frame) {
  Script script;
  int count = 0;
  {
    std::lock_guard<std::mutex> lock(mutex_);
    script = script_;
    count = frame_count_++;
  }
  return script == nullptr ? Fate::kAnswer : script(frame, count);
}

grpc::Status FakeSessionServer::StreamingSolve(grpc::ServerContext* context,
                                               Stream* stream) {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    const auto key = context->client_metadata().find("gelenk-session");
    affinity_keys_.push_back(
        key == context->client_metadata().end()
            ? ""
            : std::string(key->second.data(), key->second.size()));
  }
  const grpc::Status lost(grpc::StatusCode::UNAVAILABLE, "lost by the script");
  std::map<int, std::string> slots;
  v1::StreamingSolveRequest request;
  grpc::Status status;
  while (stream->Read(&request)) {
    if (!status.ok()) continue;  // wait for the half-close
    v1::StreamingSolveResponse response;
    for (const v1::AttachSession& attach : request.attach()) {
      *response.add_events() = Attach(attach, &slots);
    }
    if (response.events_size() > 0) stream->Write(response);
    for (const v1::TargetFrame& frame : request.frames()) {
      response.Clear();
      const Fate fate = FateOf(frame);
      if (fate == Fate::kDropBefore) return lost;
      if (fate == Fate::kTakeOver) {
        slots.erase(frame.slot());
        *response.add_events() =
            Event(v1::StreamEvent::KIND_DETACHED, frame.slot(),
                  absl::AbortedError("taken over"));
        stream->Write(response);
        continue;
      }
      if (fate == Fate::kClose) {
        const absl::Status reason = absl::ResourceExhaustedError("too slow");
        *response.add_events() =
            Event(v1::StreamEvent::KIND_CLOSING, -1, reason);
        stream->Write(response);
        status = ToGrpc(reason);
        break;
      }
      if (slots.count(frame.slot()) == 0) continue;
      absl::StatusOr<v1::PoseFrame> answer = Solve(slots[frame.slot()], frame);
      if (fate == Fate::kDropAfter) return lost;
      if (fate == Fate::kIgnore || !answer.ok()) continue;
      if (fate == Fate::kDrain) {
        *response.add_events() = Event(v1::StreamEvent::KIND_DRAINING, -1);
      }
      *response.add_frames() = *answer;
      if (fate == Fate::kAnswerTwice) *response.add_frames() = *answer;
      stream->Write(response);
    }
  }
  return status;
}

}  // namespace gelenk::testing
