// What a session is moved by, to and from gelenk.v1.Session: `retargeting` and
// `conditioning`.
#ifndef GELENK_SERVER_RPC_INPUT_MESSAGE_H_
#define GELENK_SERVER_RPC_INPUT_MESSAGE_H_

#include <memory>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/v1/session.pb.h"
#include "server/rpc/service_state.h"
#include "server/session/session.h"

namespace gelenk::server {

// Of the session on `target` with those goals. INVALID_ARGUMENT listing
// violations below the session's fields; NOT_FOUND for the source's skeleton.
absl::StatusOr<SessionInput> InputFromProto(
    const ServiceState& state, const v1::Session& proto,
    const std::shared_ptr<const Skeleton>& target,
    absl::Span<const Goal> goals);

// All but what is input only.
void InputToProto(const SessionInput& input, v1::Session* proto);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_INPUT_MESSAGE_H_
