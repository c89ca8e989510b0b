// absl::Status as gRPC says it.
#ifndef GELENK_SERVER_RPC_STATUS_H_
#define GELENK_SERVER_RPC_STATUS_H_

#include <grpcpp/support/status.h>

#include "absl/status/status.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::server {

// The codes are the same numbers. Violations travel as google.rpc.BadRequest in
// the error details, as many as a status has room for.
grpc::Status ToGrpc(const absl::Status& status);

void ToProto(const absl::Status& status, v1::FrameStatus* proto);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_STATUS_H_
