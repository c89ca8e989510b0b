// Makes the skin that a message describes.
#ifndef GELENK_SERVER_RPC_SKIN_BUILDING_H_
#define GELENK_SERVER_RPC_SKIN_BUILDING_H_

#include <memory>

#include "absl/status/statusor.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/skin.h"
#include "gelenk/v1/skin.pb.h"
#include "server/options.h"
#include "server/store/skin_store.h"

namespace gelenk::server {

// `skeleton` is that of the request; null for a bundled shape, which brings its
// own. INVALID_ARGUMENT with every violation, as paths of the message;
// UNIMPLEMENTED for a trimmed surface. Cost: some 3 us a vertex.
absl::StatusOr<std::shared_ptr<const Skin>> BuildSkin(
    std::shared_ptr<const Skeleton> skeleton, const v1::Skin& proto,
    const Limits& limits);

// `skin` with its report, to be numbered by the store.
SkinRevision MakeRevision(std::shared_ptr<const Skin> skin);

// The volumes that `skin` is in; null when it is in none.
const VolumeRig* RigOf(const Skin& skin);

// Null unless it is a mesh in layered volumes.
const LayeredSkin* AsLayered(const Skin& skin);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_BUILDING_H_
