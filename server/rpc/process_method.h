// MotionService.ProcessClip: a clip made of others.
#ifndef GELENK_SERVER_RPC_PROCESS_METHOD_H_
#define GELENK_SERVER_RPC_PROCESS_METHOD_H_

#include "absl/status/status.h"
#include "gelenk/v1/motion_service.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Errors as ApplyStep and StoreClip; nothing is kept then.
absl::Status ProcessClip(ServiceState& state,
                         const v1::ProcessClipRequest& request,
                         v1::Clip* response);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_PROCESS_METHOD_H_
