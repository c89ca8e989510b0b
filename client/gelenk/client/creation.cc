#include "gelenk/client/creation.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace gelenk::client {
namespace {

absl::Status Delete(const std::string& session_id, Connection& connection,
                    const CallOptions& options) {
  v1::DeleteSessionRequest request;
  request.set_name(absl::StrCat("sessions/", session_id));
  request.set_allow_missing(true);
  return connection
      .Call(&v1::SessionService::Stub::DeleteSession, request, options)
      .status();
}

bool IsDone(const absl::Status& status, bool again) {
  return status.ok() || (again && absl::IsAlreadyExists(status));
}

}  // namespace

absl::Status Create(const Creation& creation, Connection& connection,
                    Cancellation* cancellation) {
  CallOptions options;
  options.affinity_key = creation.affinity_key;
  options.cancellation = cancellation;
  if (creation.replaces) {
    absl::Status deleted =
        Delete(creation.session.session_id(), connection, options);
    if (!deleted.ok()) return deleted;
  }
  if (creation.skeleton.has_value()) {
    absl::Status created =
        connection
            .Call(&v1::KinematicsService::Stub::CreateSkeleton,
                  *creation.skeleton, options)
            .status();
    if (!IsDone(created, creation.again)) return created;
  }
  const absl::Status created =
      connection
          .Call(&v1::SessionService::Stub::CreateSession, creation.session,
                options)
          .status();
  return IsDone(created, creation.again) ? absl::OkStatus() : created;
}

absl::Status Adopt(SessionSpec* spec, Connection& connection,
                   Cancellation* cancellation) {
  CallOptions options;
  options.affinity_key = AffinityKey(*spec);
  options.cancellation = cancellation;
  v1::GetSessionRequest get_session;
  get_session.set_name(SessionName(*spec));
  absl::StatusOr<v1::Session> session = connection.Call(
      &v1::SessionService::Stub::GetSession, get_session, options);
  if (!session.ok()) return session.status();
  v1::GetSkeletonRequest get_skeleton;
  get_skeleton.set_name(session->skeleton());
  absl::StatusOr<v1::Skeleton> skeleton = connection.Call(
      &v1::KinematicsService::Stub::GetSkeleton, get_skeleton, options);
  if (!skeleton.ok()) return skeleton.status();

  spec->skeleton.set_skeleton_id(
      std::string(absl::StripPrefix(session->skeleton(), "skeletons/")));
  *spec->skeleton.mutable_skeleton() = *std::move(skeleton);
  session->clear_etag();
  *spec->session.mutable_session() = *std::move(session);
  return absl::OkStatus();
}

}  // namespace gelenk::client
