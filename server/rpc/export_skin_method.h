// SkinService.ExportSkin: a layered skin as a glTF file, in pieces.
#ifndef GELENK_SERVER_RPC_EXPORT_SKIN_METHOD_H_
#define GELENK_SERVER_RPC_EXPORT_SKIN_METHOD_H_

#include "gelenk/v1/skin_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Serves ExportSkin of `service` on `thread`.
void ServeExportSkin(v1::SkinService::AsyncService* service,
                     ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_EXPORT_SKIN_METHOD_H_
