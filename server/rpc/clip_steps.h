// The steps of ProcessClip, and the layers that requests lay on each other.
#ifndef GELENK_SERVER_RPC_CLIP_STEPS_H_
#define GELENK_SERVER_RPC_CLIP_STEPS_H_

#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/motion/layer_stack.h"
#include "gelenk/v1/clip_edit.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// The layers that a request has at `field`, all on `skeleton`, or where that is
// null on that of the first; 1 to 64. INVALID_ARGUMENT, NOT_FOUND for a clip,
// FAILED_PRECONDITION for one of another skeleton.
absl::StatusOr<std::vector<ClipLayer>> LayersFromProto(
    const ServiceState& state, absl::string_view field,
    std::shared_ptr<const Skeleton> skeleton,
    const google::protobuf::RepeatedPtrField<v1::ClipLayer>& protos);

// Replaces the clip of `stored` by what `step`, at `field` of the request,
// makes of it; what people should know goes to its warnings. INVALID_ARGUMENT,
// what LayersFromProto says, and FAILED_PRECONDITION where the step cannot be
// done with that skeleton or motion.
absl::Status ApplyStep(const ServiceState& state, absl::string_view field,
                       const v1::ClipStep& step, StoredClip& stored);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_CLIP_STEPS_H_
