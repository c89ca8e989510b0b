#include "server/rpc/import_skeleton_call.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "gelenk/base/violations.h"
#include "server/rpc/file_import.h"
#include "server/rpc/skeleton_message.h"
#include "server/rpc/status.h"

namespace gelenk::server {
namespace {

absl::Status Malformed(absl::string_view field, absl::string_view description) {
  Violations violations;
  violations.Add(field, description);
  return violations.ToStatus();
}

absl::Status ClientIsGone() {
  return absl::CancelledError("the client is gone");
}

absl::Status CheckHeader(const v1::ImportHeader& header) {
  Violations violations;
  if (!header.skeleton_id().empty()) {
    violations.AddStatus(
        "", CheckResourceId("header.skeleton_id", header.skeleton_id()));
  }
  violations.AddStatus("header", CheckRequestId(header.request_id()));
  violations.AddStatus("", CheckImportFormat(header));
  return violations.ToStatus();
}

}  // namespace

void ImportSkeletonCall::Start(v1::KinematicsService::AsyncService* service,
                               ServiceState* state, IoThread* thread) {
  new ImportSkeletonCall(service, state, thread);
}

ImportSkeletonCall::ImportSkeletonCall(
    v1::KinematicsService::AsyncService* service, ServiceState* state,
    IoThread* thread)
    : service_(service), state_(state), thread_(thread), count_(*thread) {
  grpc::ServerCompletionQueue* queue = thread_->queue();
  context_.AsyncNotifyWhenDone(done_.tag());
  service_->RequestImportSkeleton(&context_, &reader_, queue, queue,
                                  started_.tag());
}

ImportSkeletonCall::~ImportSkeletonCall() {
  if (ticking_) thread_->RemoveTicking(this);
}

void ImportSkeletonCall::OnStarted(bool ok) {
  if (!ok) {  // the server is shutting down; `done_` never comes
    delete this;
    return;
  }
  Start(service_, state_, thread_);
  place_ = std::make_unique<LimitedPlace>(state_->imports,
                                          state_->options.limits.max_imports);
  if (!place_->granted()) {
    Finish(absl::ResourceExhaustedError("too many imports are under way"));
    return;
  }
  thread_->AddTicking(this);
  ticking_ = true;
  Read();
}

void ImportSkeletonCall::Read() {
  last_read_ = absl::Now();
  reading_ = true;
  reader_.Read(&request_, read_.tag());
}

void ImportSkeletonCall::Tick(absl::Time now) {
  const absl::Duration stall = state_->options.limits.import_stall;
  // While a worker is at the call, nothing is read.
  if (!reading_ || finishing_ || now - last_read_ < stall) return;
  Finish(absl::DeadlineExceededError(
      absl::StrCat("data: no piece came for ", absl::FormatDuration(stall))));
}

void ImportSkeletonCall::OnRead(bool ok) {
  reading_ = false;
  if (finishing_) {
    DeleteIfDone();
    return;
  }
  if (ok) {
    if (absl::Status status = Take(); !status.ok()) {
      Finish(status);
      return;
    }
    Read();
    return;
  }
  if (!has_header_) {
    Finish(Malformed("header", "the first message must hold it"));
    return;
  }
  // The reads of a cancelled call end as if it was half-closed; OnDone, which
  // tells the difference, is right behind.
  alarm_.Set(thread_->queue(), std::chrono::system_clock::now(),
             settled_.tag());
}

void ImportSkeletonCall::OnSettled(bool) {
  if (cancelled_) {
    Finish(ClientIsGone());
    return;
  }
  const bool taken =
      state_->workers.Submit([this](IkSolver&) { Finish(Import()); });
  if (!taken) {
    Finish(absl::ResourceExhaustedError("too many calls are waiting"));
  }
}

absl::Status ImportSkeletonCall::Take() {
  if (request_.has_header() == has_header_) {
    return Malformed("header", "the first message must hold it, and no other");
  }
  if (request_.has_header()) {
    has_header_ = true;
    header_ = request_.header();
    if (absl::Status status = CheckHeader(header_); !status.ok()) {
      return status;
    }
  }
  const int64_t most = state_->options.limits.max_import_bytes;
  if (static_cast<int64_t>(data_.size() + request_.data().size()) > most) {
    return Malformed("data", absl::StrCat("want at most ", most, " bytes"));
  }
  data_ += request_.data();
  return absl::OkStatus();
}

absl::Status ImportSkeletonCall::Import() {
  absl::StatusOr<FileImport> import =
      ImportFile(header_, std::move(data_), state_->options.limits);
  if (!import.ok()) return import.status();

  if (cancelled_) return ClientIsGone();
  import->skeleton.create_time = absl::Now();
  absl::StatusOr<StoredSkeleton> stored = state_->skeletons.Create(
      kDefaultTenant, header_.skeleton_id(), header_.request_id(),
      std::move(import->skeleton));
  if (!stored.ok()) return stored.status();
  ToProto(*stored, response_.mutable_skeleton());
  response_.set_unit_m(import->unit_m);
  return absl::OkStatus();
}

void ImportSkeletonCall::Finish(const absl::Status& status) {
  finishing_ = true;
  if (status.ok()) {
    reader_.Finish(response_, grpc::Status::OK, finished_.tag());
  } else {
    reader_.FinishWithError(ToGrpc(status), finished_.tag());
  }
}

void ImportSkeletonCall::OnDone(bool) {
  is_done_ = true;
  cancelled_ = context_.IsCancelled();
  DeleteIfDone();
}

void ImportSkeletonCall::OnFinished(bool) {
  finished_call_ = true;
  DeleteIfDone();
}

void ImportSkeletonCall::DeleteIfDone() {
  if (finished_call_ && is_done_ && !reading_) delete this;
}

}  // namespace gelenk::server
