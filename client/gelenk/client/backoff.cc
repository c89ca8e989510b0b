#include "gelenk/client/backoff.h"

#include <algorithm>

namespace gelenk::client {

Backoff::Backoff(const BackoffOptions& options, uint64_t seed)
    : options_(options), ceiling_(options.initial_ceiling), random_(seed) {}

absl::Duration Backoff::Next() {
  const absl::Duration ceiling = std::min(ceiling_, options_.max_ceiling);
  ceiling_ = std::min(ceiling_ * options_.multiplier, options_.max_ceiling);
  if (ceiling <= options_.floor) return ceiling;
  std::uniform_real_distribution<double> fraction(0, 1);
  return options_.floor + (ceiling - options_.floor) * fraction(random_);
}

void Backoff::Reset() { ceiling_ = options_.initial_ceiling; }

}  // namespace gelenk::client
