#include "server/ops/logging.h"

#include <spdlog/sinks/stdout_color_sinks.h>

namespace gelenk::server {

void StartLogging(const std::string& level) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("gelenkd"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %^%l%$ %v");
  spdlog::set_level(spdlog::level::from_str(level));
}

}  // namespace gelenk::server
