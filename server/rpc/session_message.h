// gelenk.v1.Session and its parts to and from the domain's sessions.
#ifndef GELENK_SERVER_RPC_SESSION_MESSAGE_H_
#define GELENK_SERVER_RPC_SESSION_MESSAGE_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "convert/retargeting.h"
#include "convert/solver.h"
#include "gelenk/v1/session.pb.h"
#include "gelenk/v1/session_service.pb.h"
#include "server/options.h"
#include "server/session/session.h"

namespace gelenk::server {

// Everything of `session`; `draining` is the server's.
void ToProto(const Session& session, bool draining, v1::Session* proto);

// What a new session shall be, every violation listed but those that goals, all
// of a kind, show only when a problem is made of them. With an error `state`
// holds the parts that are good, so that its goals can be looked at all the
// same.
absl::Status StateFromProto(const v1::Session& proto, const Skeleton& skeleton,
                            const Limits& limits, SessionState& state);

// Replaces the parts of `state` that `request` names; errors as above.
absl::Status UpdateState(const v1::UpdateSessionRequest& request,
                         const Skeleton& skeleton, const Limits& limits,
                         SessionState& state);

// The revision in an etag; unset for an empty one, INVALID_ARGUMENT for one
// that this server never gave.
absl::StatusOr<std::optional<int64_t>> RevisionOf(const std::string& etag);

void ToProto(absl::Time time, google::protobuf::Timestamp* proto);

// What a solve, or a retargeted frame, took, into an answer of a stream or a
// call; `whole` asks for all of it. Allocates nothing once `answer` has held
// as much.
template <class Answer>
void ReportsToProto(const SolvedFrame& solved, bool whole, Answer* answer) {
  if (!solved.retarget_report) {
    convert::ToProto(solved.report, solved.detail, solved.solve_duration,
                     answer->mutable_report());
    return;
  }
  convert::ToFollowedReport(solved.solve_duration, answer->mutable_report());
  if (!whole) return;
  convert::ToProto(*solved.retarget_report, answer->mutable_retarget_report());
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SESSION_MESSAGE_H_
