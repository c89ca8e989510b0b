// What a command makes on a service and takes away again.
#ifndef CLIENT_CLI_MADE_SESSION_H_
#define CLIENT_CLI_MADE_SESSION_H_

#include "gelenk/client/connection.h"
#include "gelenk/client/session_spec.h"

namespace gelenk::cli {

// Deletes the session and the skeletons that `spec`, with ids, has made. What
// is gone already is no error.
void DeleteMade(client::Connection& connection,
                const client::SessionSpec& spec);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MADE_SESSION_H_
