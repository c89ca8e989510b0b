#include "client/cli/skin/served_skin.h"

#include <utility>

#include "absl/strings/match.h"
#include "client/cli/skin/skin_sending.h"
#include "client/cli/unique_id.h"

namespace gelenk::cli {

absl::StatusOr<std::unique_ptr<ServedSkin>> ServedSkin::Open(
    std::shared_ptr<client::Connection> connection,
    const SkinSourceOptions& source, const std::string& keep_id,
    const v1::LayeredVolumes& volumes) {
  absl::Status status = CheckSourceOptions(source);
  if (!status.ok()) return status;
  std::unique_ptr<ServedSkin> served(new ServedSkin(std::move(connection)));
  status = absl::StartsWith(source.path, "skins/")
               ? served->Find(source.path)
               : served->Create(source, keep_id, volumes);
  if (!status.ok()) return status;
  return served;
}

ServedSkin::ServedSkin(std::shared_ptr<client::Connection> connection)
    : connection_(std::move(connection)) {}

ServedSkin::~ServedSkin() {
  // What cannot be deleted now is of no harm to the command's result.
  if (!temporary_skin_.empty()) {
    v1::DeleteSkinRequest request;
    request.set_name(temporary_skin_);
    connection_->Call(&SkinStub::DeleteSkin, request).IgnoreError();
  }
  if (!temporary_skeleton_.empty()) {
    v1::DeleteSkeletonRequest request;
    request.set_name(temporary_skeleton_);
    connection_->Call(&v1::KinematicsService::Stub::DeleteSkeleton, request)
        .IgnoreError();
  }
}

absl::Status ServedSkin::Find(const std::string& name) {
  v1::GetSkinRequest request;
  request.set_name(name);
  absl::StatusOr<v1::Skin> found =
      connection_->Call(&SkinStub::GetSkin, request);
  if (found.ok()) skin_ = *std::move(found);
  return found.status();
}

absl::Status ServedSkin::Create(const SkinSourceOptions& options,
                                const std::string& keep_id,
                                const v1::LayeredVolumes& volumes) {
  absl::StatusOr<SkinSource> source = ReadSkinSource(options);
  if (!source.ok()) return source.status();
  warnings_ = std::move(source->warnings);
  v1::CreateSkinRequest request;
  request.set_skin_id(keep_id.empty() ? UniqueId() : keep_id);
  request.set_request_id(UniqueId());
  *request.mutable_skin() = std::move(source->skin);
  if (volumes.assignments_size() > 0) {
    const auto deformer = request.skin().deformer_case();
    if (deformer != v1::Skin::kLayeredVolumes &&
        deformer != v1::Skin::DEFORMER_NOT_SET) {
      return absl::InvalidArgumentError(
          "--assignments: are of vertices in volumes, the skin has weights");
    }
    *request.mutable_skin()->mutable_layered_volumes()->mutable_assignments() =
        volumes.assignments();
  }
  if (source->skeleton) {
    v1::CreateSkeletonRequest upload;
    upload.set_skeleton_id(UniqueId());
    upload.set_request_id(upload.skeleton_id());
    *upload.mutable_skeleton() = *std::move(source->skeleton);
    const absl::StatusOr<v1::Skeleton> created =
        connection_->Call(&v1::KinematicsService::Stub::CreateSkeleton, upload);
    if (!created.ok()) return created.status();
    temporary_skeleton_ = created->name();
    request.mutable_skin()->set_skeleton(created->name());
  }
  absl::StatusOr<v1::Skin> created = SendSkin(*connection_, std::move(request));
  if (!created.ok()) return created.status();
  skin_ = *std::move(created);
  temporary_skin_ = keep_id.empty() ? skin_.name() : "";
  temporary_skeleton_ = keep_id.empty() ? skin_.skeleton() : "";
  return absl::OkStatus();
}

absl::StatusOr<v1::Skeleton> ServedSkin::ReadSkeleton() const {
  v1::GetSkeletonRequest request;
  request.set_name(skin_.skeleton());
  return connection_->Call(&v1::KinematicsService::Stub::GetSkeleton, request);
}

}  // namespace gelenk::cli
