// The skins that a server keeps.
#ifndef CLIENT_CLI_SKIN_SKIN_LIST_H_
#define CLIENT_CLI_SKIN_SKIN_LIST_H_

#include <string>

#include "absl/status/status.h"
#include "client/cli/text/format.h"
#include "gelenk/client/connection.h"

namespace gelenk::cli {

// A line each.
absl::Status PrintSkins(client::Connection& connection, Format format,
                        std::string* output);

// With all its revisions; its skeleton stays. INVALID_ARGUMENT unless `name` is
// skins/NAME.
absl::Status DeleteSkin(client::Connection& connection,
                        const std::string& name);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SKIN_LIST_H_
