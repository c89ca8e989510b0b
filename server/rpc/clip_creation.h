// Keyframes or a file in, a stored clip out.
#ifndef GELENK_SERVER_RPC_CLIP_CREATION_H_
#define GELENK_SERVER_RPC_CLIP_CREATION_H_

#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "gelenk/v1/motion_service.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// What a new clip is called.
struct NewClip {
  // Checked, or empty.
  std::string id;
  std::string request_id;
};

// Stores `clip`, whose skeleton is stored first, under a name of its own, when
// `clip.skeleton_name` is empty; of two calls with one request_id one keeps
// neither. Errors as ClipStore::Create.
absl::StatusOr<StoredClip> StoreClip(ServiceState& state, const NewClip& named,
                                     StoredClip clip);

// A clip made of others or of poses, for StoreClip.
StoredClip MadeClip(const StoredClip& source, MotionClip clip,
                    const std::string& display_name);

// CreateClip. Nothing is kept where `is_cancelled`, asked before the clip is
// stored, says that nobody waits for it. INVALID_ARGUMENT listing what of the
// request is malformed; errors of the file's reader; as StoreClip.
absl::StatusOr<StoredClip> CreateClip(
    ServiceState& state, const v1::CreateClipRequest& request,
    const std::function<bool()>& is_cancelled);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_CLIP_CREATION_H_
