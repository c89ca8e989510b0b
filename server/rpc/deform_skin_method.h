// SkinService.DeformSkin: poses in, a frame each out, made one by one as the
// reader takes them.
#ifndef GELENK_SERVER_RPC_DEFORM_SKIN_METHOD_H_
#define GELENK_SERVER_RPC_DEFORM_SKIN_METHOD_H_

#include "gelenk/v1/skin_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves DeformSkin of `service` on `thread`.
void ServeDeformSkin(v1::SkinService::AsyncService* service,
                     ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_DEFORM_SKIN_METHOD_H_
