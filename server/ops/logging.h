// Log lines on standard error.
#ifndef GELENK_SERVER_OPS_LOGGING_H_
#define GELENK_SERVER_OPS_LOGGING_H_

#include <spdlog/spdlog.h>

#include <string>

namespace gelenk::server {

// `level` is one of spdlog's names.
void StartLogging(const std::string& level);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_OPS_LOGGING_H_
