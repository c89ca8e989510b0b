// gelenk.v1.SessionService: warm solvers, driven call by call or by streams.
#ifndef GELENK_SERVER_RPC_SESSION_SERVICE_H_
#define GELENK_SERVER_RPC_SESSION_SERVICE_H_

#include "gelenk/v1/session_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves every method of `service` on `thread`.
void ServeSessions(v1::SessionService::AsyncService* service,
                   ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SESSION_SERVICE_H_
