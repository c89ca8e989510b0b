// Sessions of a service, for people and for programs.
#ifndef CLIENT_CLI_SESSION_TEXT_H_
#define CLIENT_CLI_SESSION_TEXT_H_

#include <string>
#include <vector>

#include "client/cli/text/format.h"
#include "gelenk/v1/session.pb.h"

namespace gelenk::cli {

std::string SessionListText(const std::vector<v1::Session>& sessions);
std::string SessionText(const v1::Session& session);

// The contract's own JSON.
Json SessionListJson(const std::vector<v1::Session>& sessions);
Json SessionJson(const v1::Session& session);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SESSION_TEXT_H_
