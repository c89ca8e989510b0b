// gelenk.v1.KinematicsService: immutable skeletons, and kinematics that leave
// nothing behind.
#ifndef GELENK_SERVER_RPC_KINEMATICS_SERVICE_H_
#define GELENK_SERVER_RPC_KINEMATICS_SERVICE_H_

#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves every method of `service` on `thread`.
void ServeKinematics(v1::KinematicsService::AsyncService* service,
                     ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_KINEMATICS_SERVICE_H_
