#include "client/cli/uploaded_skeleton.h"

#include <utility>

#include "client/cli/unique_id.h"

namespace gelenk::cli {

absl::StatusOr<std::unique_ptr<UploadedSkeleton>> UploadedSkeleton::Create(
    std::shared_ptr<client::Connection> connection,
    const v1::Skeleton& skeleton) {
  v1::CreateSkeletonRequest request;
  request.set_skeleton_id(UniqueId());
  request.set_request_id(request.skeleton_id());
  *request.mutable_skeleton() = skeleton;
  const absl::StatusOr<v1::Skeleton> created =
      connection->Call(&v1::KinematicsService::Stub::CreateSkeleton, request);
  if (!created.ok()) return created.status();
  return std::unique_ptr<UploadedSkeleton>(
      new UploadedSkeleton(std::move(connection), created->name()));
}

UploadedSkeleton::UploadedSkeleton(
    std::shared_ptr<client::Connection> connection, std::string name)
    : connection_(std::move(connection)), name_(std::move(name)) {}

UploadedSkeleton::~UploadedSkeleton() {
  v1::DeleteSkeletonRequest request;
  request.set_name(name_);
  request.set_allow_missing(true);
  // What cannot be deleted now is of no harm to the command's result.
  connection_->Call(&v1::KinematicsService::Stub::DeleteSkeleton, request)
      .IgnoreError();
}

}  // namespace gelenk::cli
