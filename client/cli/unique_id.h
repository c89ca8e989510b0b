// Names for what the CLI creates on a server.
#ifndef CLIENT_CLI_UNIQUE_ID_H_
#define CLIENT_CLI_UNIQUE_ID_H_

#include <string>

namespace gelenk::cli {

// "cli-" and 16 random hexadecimal digits: a valid id and request id, met
// nowhere else.
std::string UniqueId();

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_UNIQUE_ID_H_
