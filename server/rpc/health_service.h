// grpc.health.v1.Health on the I/O threads. gRPC's own would bring threads that
// poll the same connections, which costs every frame of every stream.
#ifndef GELENK_SERVER_RPC_HEALTH_SERVICE_H_
#define GELENK_SERVER_RPC_HEALTH_SERVICE_H_

#include "grpc/health/v1/health.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// SERVING until the server drains, for the whole server and for each of its
// services.
void ServeHealth(grpc::health::v1::Health::AsyncService* service,
                 ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_HEALTH_SERVICE_H_
