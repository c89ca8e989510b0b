// gelenk.v1.Skin of what is stored, and skins that requests name.
#ifndef GELENK_SERVER_RPC_SKIN_MESSAGE_H_
#define GELENK_SERVER_RPC_SKIN_MESSAGE_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/v1/skin.pb.h"
#include "server/rpc/service_state.h"
#include "server/session/revision_name.h"

namespace gelenk::server {

// Everything but vertex data.
void ToProto(const StoredSkin& stored, v1::Skin* proto);

// "skins/{skin}" or "skins/{skin}@{revision}". INVALID_ARGUMENT naming `field`,
// NOT_FOUND.
absl::StatusOr<StoredSkin> FindSkin(const ServiceState& state,
                                    absl::string_view field,
                                    const std::string& name);

// A session that shows `skin`. INVALID_ARGUMENT naming `field` when it is on
// another skeleton, NOT_FOUND.
absl::StatusOr<std::shared_ptr<Session>> FindSessionOf(
    const ServiceState& state, const StoredSkin& skin, absl::string_view field,
    const std::string& name);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SKIN_MESSAGE_H_
