// SkinService: what decides about a skin after it was made. Muscles, bindings,
// revisions.
#ifndef GELENK_SERVER_RPC_SKIN_EDIT_METHODS_H_
#define GELENK_SERVER_RPC_SKIN_EDIT_METHODS_H_

#include "gelenk/v1/skin_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves UpdateMuscles, GetBinding, RebindVertices and RollbackSkin of
// `service` on `thread`.
void ServeSkinEdits(v1::SkinService::AsyncService* service, ServiceState* state,
                    IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_EDIT_METHODS_H_
