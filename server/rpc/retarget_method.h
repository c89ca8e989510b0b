// MotionService.RetargetClip.
#ifndef GELENK_SERVER_RPC_RETARGET_METHOD_H_
#define GELENK_SERVER_RPC_RETARGET_METHOD_H_

#include "absl/status/status.h"
#include "gelenk/v1/motion_service.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

absl::Status RetargetClip(ServiceState& state,
                          const v1::RetargetClipRequest& request,
                          v1::Clip* response);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_RETARGET_METHOD_H_
