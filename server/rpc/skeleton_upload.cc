#include "server/rpc/skeleton_upload.h"

#include <memory>
#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "gelenk/base/violations.h"
#include "server/rpc/file_import.h"
#include "server/rpc/piece_check.h"
#include "server/rpc/skeleton_message.h"
#include "server/rpc/upload_call.h"

namespace gelenk::server {
namespace {

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

class SkeletonUpload final
    : public Upload<v1::ImportSkeletonRequest, v1::ImportSkeletonResponse> {
 public:
  explicit SkeletonUpload(ServiceState* state) : state_(state) {}

  absl::Status Take(v1::ImportSkeletonRequest& piece) override {
    if (absl::Status status =
            CheckHeaderComesFirst(piece.has_header(), !has_header_);
        !status.ok()) {
      return status;
    }
    if (piece.has_header()) {
      has_header_ = true;
      header_ = piece.header();
      if (absl::Status status = CheckHeader(header_); !status.ok()) {
        return status;
      }
    }
    if (absl::Status status =
            CheckUploadSize("data", data_.size() + piece.data().size(),
                            state_->options.limits.max_import_bytes);
        !status.ok()) {
      return status;
    }
    data_ += piece.data();
    return absl::OkStatus();
  }

  absl::Status Complete(const std::function<bool()>& is_cancelled,
                        v1::ImportSkeletonResponse* response) override {
    if (!has_header_) {
      return MalformedPiece("header", "the first message must hold it");
    }
    absl::StatusOr<FileImport> import =
        ImportFile(header_, std::move(data_), state_->options.limits);
    if (!import.ok()) return import.status();

    if (is_cancelled()) return ClientIsGone();
    import->skeleton.create_time = absl::Now();
    absl::StatusOr<StoredSkeleton> stored = state_->skeletons.Create(
        kDefaultTenant, header_.skeleton_id(), header_.request_id(),
        std::move(import->skeleton));
    if (!stored.ok()) return stored.status();
    ToProto(*stored, response->mutable_skeleton());
    response->set_unit_m(import->unit_m);
    return absl::OkStatus();
  }

 private:
  ServiceState* const state_;
  bool has_header_ = false;
  v1::ImportHeader header_;
  std::string data_;
};

}  // namespace

void ServeSkeletonUploads(v1::KinematicsService::AsyncService* service,
                          ServiceState* state, IoThread* thread) {
  ServeUpload(
      service, &v1::KinematicsService::AsyncService::RequestImportSkeleton,
      [state] { return std::make_unique<SkeletonUpload>(state); }, state,
      thread);
}

}  // namespace gelenk::server
