// The unary calls that make a session: first, or again after it was lost.
#ifndef GELENK_CLIENT_CREATION_H_
#define GELENK_CLIENT_CREATION_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "gelenk/client/cancellation.h"
#include "gelenk/client/connection.h"
#include "gelenk/client/session_spec.h"

namespace gelenk::client {

struct Creation {
  std::optional<v1::CreateSkeletonRequest> skeleton;
  std::optional<v1::CreateSkeletonRequest> source_skeleton;
  // Without a session in it: the session is there, and is read.
  v1::CreateSessionRequest session;
  std::string affinity_key;
  // Both may be there already, from an attempt whose answer was lost.
  bool again = false;
  // There is one whose state is of no use: it is deleted first.
  bool replaces = false;
};

// Blocks for some calls. Errors are those of the server or of the connection.
absl::Status Create(const Creation& creation, Connection& connection,
                    Cancellation* cancellation);

// Reads a session that is there, and its skeleton, into `spec`.
absl::Status Adopt(SessionSpec* spec, Connection& connection,
                   Cancellation* cancellation);

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_CREATION_H_
