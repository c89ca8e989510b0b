#include "server/version.h"

namespace gelenk::server {

std::string Version() { return GELENK_VERSION; }

std::string BuildId() {
  return GELENK_VERSION "+gcc-" __VERSION__ "-" GELENK_BUILD_TYPE;
}

}  // namespace gelenk::server
