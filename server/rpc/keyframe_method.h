// MotionService.EditKeyframes: a clip's next revision.
#ifndef GELENK_SERVER_RPC_KEYFRAME_METHOD_H_
#define GELENK_SERVER_RPC_KEYFRAME_METHOD_H_

#include "absl/status/status.h"
#include "gelenk/v1/motion_service.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// INVALID_ARGUMENT as "edits[2].insert_key.part: ...", NOT_FOUND,
// FAILED_PRECONDITION for a session of another skeleton, RESOURCE_EXHAUSTED.
absl::Status EditKeyframes(ServiceState& state,
                           const v1::EditKeyframesRequest& request,
                           v1::Clip* response);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_KEYFRAME_METHOD_H_
