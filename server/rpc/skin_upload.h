// SkinService.UploadSkin: a CreateSkin request that comes in pieces.
#ifndef GELENK_SERVER_RPC_SKIN_UPLOAD_H_
#define GELENK_SERVER_RPC_SKIN_UPLOAD_H_

#include "gelenk/v1/skin_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

void ServeSkinUploads(v1::SkinService::AsyncService* service,
                      ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_UPLOAD_H_
