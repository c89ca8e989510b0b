// gelenk.v1.SkinService: skins, their bindings, and their vertices.
#ifndef GELENK_SERVER_RPC_SKIN_SERVICE_H_
#define GELENK_SERVER_RPC_SKIN_SERVICE_H_

#include "gelenk/v1/skin_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves every method of `service` on `thread`.
void ServeSkins(v1::SkinService::AsyncService* service, ServiceState* state,
                IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_SERVICE_H_
