// gelenk skin deform: vertices at poses.
#ifndef CLIENT_CLI_SKIN_DEFORM_STEP_H_
#define CLIENT_CLI_SKIN_DEFORM_STEP_H_

#include <string>

#include "absl/status/status.h"
#include "client/cli/skin/served_skin.h"
#include "client/cli/skin/skin_options.h"
#include "gelenk/client/connection.h"

namespace gelenk::cli {

// Tells of the frames, link by link where volumes fold or muscles are clamped;
// draws some, writes the last, where `options` say so.
absl::Status RunDeform(const SkinOptions& options,
                       client::Connection& connection, const ServedSkin& served,
                       std::string* output);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_DEFORM_STEP_H_
