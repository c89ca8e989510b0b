#include "server/rpc/import_skeleton_call.h"

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
  service_->RequestImportSkeleton(&context_, &reader_, queue, queue, &started_);
}

void ImportSkeletonCall::OnStarted(bool ok) {
  if (!ok) {  // the server is shutting down
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
  reader_.Read(&request_, &read_);
}

void ImportSkeletonCall::OnRead(bool ok) {
  if (ok) {
    if (absl::Status status = Take(); !status.ok()) {
      Finish(status);
      return;
    }
    reader_.Read(&request_, &read_);
    return;
  }
  if (!has_header_) {
    Finish(Malformed("header", "the first message must hold it"));
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
  if (status.ok()) {
    reader_.Finish(response_, grpc::Status::OK, &finished_);
  } else {
    reader_.FinishWithError(ToGrpc(status), &finished_);
  }
}

void ImportSkeletonCall::OnFinished(bool) { delete this; }

}  // namespace gelenk::server
