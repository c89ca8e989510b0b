// A surface and what deforms it in, a stored skin out.
#ifndef GELENK_SERVER_RPC_SKIN_CREATION_H_
#define GELENK_SERVER_RPC_SKIN_CREATION_H_

#include <functional>

#include "absl/status/status.h"
#include "gelenk/v1/skin_service.pb.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

// CreateSkin: binds, stores, and answers without vertices. Nothing is kept
// where `is_cancelled`, asked before the skin is stored, says that nobody waits
// for it. INVALID_ARGUMENT listing what of the request is malformed; errors of
// SkinStore::Create. Cost: that of BuildSkin.
absl::Status CreateSkin(ServiceState& state,
                        const v1::CreateSkinRequest& request,
                        const std::function<bool()>& is_cancelled,
                        v1::Skin* response);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_CREATION_H_
