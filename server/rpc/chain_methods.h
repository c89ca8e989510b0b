// The methods of KinematicsService about chains: Jacobians,
// Denavit-Hartenberg tables, closed forms.
#ifndef GELENK_SERVER_RPC_CHAIN_METHODS_H_
#define GELENK_SERVER_RPC_CHAIN_METHODS_H_

#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves them on `thread`.
void ServeChains(v1::KinematicsService::AsyncService* service,
                 ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_CHAIN_METHODS_H_
