// MotionService.StartRecording and StopRecording.
#ifndef GELENK_SERVER_RPC_RECORDING_METHODS_H_
#define GELENK_SERVER_RPC_RECORDING_METHODS_H_

#include "gelenk/v1/motion_service.grpc.pb.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

void ServeRecordings(v1::MotionService::AsyncService* service,
                     ServiceState* state, IoThread* thread);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_RECORDING_METHODS_H_
