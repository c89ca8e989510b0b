// KinematicsService.BatchSolve: many independent problems in one call.
#ifndef GELENK_SERVER_RPC_BATCH_METHOD_H_
#define GELENK_SERVER_RPC_BATCH_METHOD_H_

#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// A message of 4 MB holds about as many poses.
inline constexpr int kMaxBatchProblems = 65536;

// Serves it on `thread`.
void ServeBatch(v1::KinematicsService::AsyncService* service,
                ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_BATCH_METHOD_H_
