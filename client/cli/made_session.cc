#include "client/cli/made_session.h"

#include "absl/strings/str_cat.h"

namespace gelenk::cli {

void DeleteMade(client::Connection& connection,
                const client::SessionSpec& spec) {
  client::CallOptions options;
  options.affinity_key = client::AffinityKey(spec);
  v1::DeleteSessionRequest session;
  session.set_name(client::SessionName(spec));
  session.set_allow_missing(true);
  connection.Call(&v1::SessionService::Stub::DeleteSession, session, options)
      .IgnoreError();
  for (const auto* made : {&spec.skeleton, &spec.source_skeleton}) {
    if (!made->has_skeleton()) continue;
    v1::DeleteSkeletonRequest skeleton;
    skeleton.set_name(absl::StrCat("skeletons/", made->skeleton_id()));
    skeleton.set_allow_missing(true);
    connection.Call(&v1::KinematicsService::Stub::DeleteSkeleton, skeleton)
        .IgnoreError();
  }
}

}  // namespace gelenk::cli
