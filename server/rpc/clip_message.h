// gelenk.v1.Clip of what the store keeps, and clips that requests name.
#ifndef GELENK_SERVER_RPC_CLIP_MESSAGE_H_
#define GELENK_SERVER_RPC_CLIP_MESSAGE_H_

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/v1/motion.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// Everything but tracks.
void ToProto(const StoredClip& stored, v1::Clip* proto);

// INVALID_ARGUMENT naming `field` when `name` is malformed, NOT_FOUND when
// there is no such clip or revision.
absl::StatusOr<StoredClip> FindClip(const ServiceState& state,
                                    absl::string_view field,
                                    absl::string_view name);

// INVALID_ARGUMENT naming `field` where a clip of `frames` frames would have
// more numbers than one may have.
absl::Status CheckFrameCount(absl::string_view field, double frames,
                             const Skeleton& skeleton, const Limits& limits);

// The same for the frames of `clip` at its frame time.
absl::Status CheckFrameCount(absl::string_view field, const MotionClip& clip,
                             const Limits& limits);

// Fills `response` with what `request_id` made earlier, if that is still there.
bool AnswerEarlier(const ServiceState& state, absl::string_view request_id,
                   v1::Clip* response);

// The id and request_id of a request that makes a clip.
absl::Status CheckNewClip(absl::string_view id_field, const std::string& id,
                          const std::string& request_id);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_CLIP_MESSAGE_H_
