// How often viewers are served.
#ifndef GELENK_SERVER_RPC_WATCH_INTERVAL_H_
#define GELENK_SERVER_RPC_WATCH_INTERVAL_H_

#include <algorithm>

#include "absl/time/time.h"
#include "convert/duration.h"

namespace gelenk::server {

// The least time between two messages to a viewer, as `request` asks for it:
// by default one frame of a 60 Hz display. No viewer draws faster than the
// least, and the look costs the I/O thread.
template <class Request>
absl::Duration WatchInterval(const Request& request) {
  constexpr absl::Duration kDefault = absl::Milliseconds(16);
  constexpr absl::Duration kLeast = absl::Milliseconds(2);
  constexpr absl::Duration kMost = absl::Seconds(1);
  if (!request.has_min_interval()) return kDefault;
  return std::clamp(convert::FromProto(request.min_interval()), kLeast, kMost);
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_WATCH_INTERVAL_H_
