// An arm that bends with its biceps on, and without: a picture and a file.
#ifndef CLIENT_CLI_SKIN_SKIN_DEMO_H_
#define CLIENT_CLI_SKIN_SKIN_DEMO_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "gelenk/client/connection.h"

namespace gelenk::cli {

struct SkinDemoOptions {
  std::string picture_path;
  std::string glb_path;
  int vertex_count = 3000;
};

absl::Status RunSkinDemo(const SkinDemoOptions& options,
                         const std::shared_ptr<client::Connection>& connection,
                         std::string* output);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SKIN_DEMO_H_
