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

// Reads a skeleton that is there into what would create it.
absl::Status AdoptSkeleton(const std::string& name, Connection& connection,
                           const CallOptions& options,
                           v1::CreateSkeletonRequest* request) {
  v1::GetSkeletonRequest get;
  get.set_name(name);
  absl::StatusOr<v1::Skeleton> skeleton =
      connection.Call(&v1::KinematicsService::Stub::GetSkeleton, get, options);
  if (!skeleton.ok()) return skeleton.status();
  request->set_skeleton_id(std::string(absl::StripPrefix(name, "skeletons/")));
  *request->mutable_skeleton() = *std::move(skeleton);
  return absl::OkStatus();
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
  for (const auto* skeleton : {&creation.skeleton, &creation.source_skeleton}) {
    if (!skeleton->has_value()) continue;
    absl::Status created =
        connection
            .Call(&v1::KinematicsService::Stub::CreateSkeleton, **skeleton,
                  options)
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
  absl::Status read =
      AdoptSkeleton(session->skeleton(), connection, options, &spec->skeleton);
  if (!read.ok()) return read;
  const std::string& source = session->retargeting().source_skeleton();
  if (!source.empty()) {
    read = AdoptSkeleton(source, connection, options, &spec->source_skeleton);
    if (!read.ok()) return read;
  }
  session->clear_etag();
  *spec->session.mutable_session() = *std::move(session);
  return absl::OkStatus();
}

}  // namespace gelenk::client
