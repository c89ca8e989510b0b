// What became of a call, in the terms of the rest of the code.
#ifndef GELENK_CLIENT_STATUS_H_
#define GELENK_CLIENT_STATUS_H_

#include <grpcpp/support/status.h>

#include "absl/status/status.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::client {

// Same code, same message.
absl::Status FromGrpc(const grpc::Status& status);

// The status inside a frame or an event of a stream.
absl::Status FromProto(const v1::FrameStatus& status);

// True when the connection or the server went away, and the same call may
// succeed on the next one. What that looks like depends on what stands between:
// UNAVAILABLE, INTERNAL naming a reset, UNKNOWN "Stream removed", or CANCELLED:
// do not ask about a call that was cancelled on this side.
bool IsTransportLoss(const absl::Status& status);

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_STATUS_H_
