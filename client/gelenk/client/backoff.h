// How long to wait before the next attempt: exponential, jittered.
#ifndef GELENK_CLIENT_BACKOFF_H_
#define GELENK_CLIENT_BACKOFF_H_

#include <cstdint>
#include <random>

#include "absl/time/time.h"

namespace gelenk::client {

struct BackoffOptions {
  // No wait is shorter.
  absl::Duration floor = absl::Milliseconds(20);
  // The first wait is below this.
  absl::Duration initial_ceiling = absl::Milliseconds(50);
  // How the ceiling grows with every wait.
  double multiplier = 2;
  // No wait is longer.
  absl::Duration max_ceiling = absl::Seconds(2);
};

// Every wait is uniform between the floor and a growing ceiling, so that the
// clients of a server that died do not come back in step. Sleeps nowhere and
// reads no clock. Not thread-safe.
class Backoff {
 public:
  Backoff(const BackoffOptions& options, uint64_t seed);

  absl::Duration Next();

  // An attempt succeeded: the next wait is a first one again.
  void Reset();

 private:
  BackoffOptions options_;
  absl::Duration ceiling_;
  std::mt19937_64 random_;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_BACKOFF_H_
