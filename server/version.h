// What this server is.
#ifndef GELENK_SERVER_VERSION_H_
#define GELENK_SERVER_VERSION_H_

#include <string>

namespace gelenk::server {

// Semantic version of the project.
std::string Version();

// Names the code that solves: two servers with the same build id and the same
// instruction set answer with the same bits.
std::string BuildId();

}  // namespace gelenk::server

#endif  // GELENK_SERVER_VERSION_H_
