#include "gelenk/client/stream_statistics.h"

#include <algorithm>
#include <cmath>

namespace gelenk::client {

void RoundTrips::Add(absl::Duration round_trip) {
  if (samples_.size() < capacity_) {
    samples_.push_back(round_trip);
    return;
  }
  samples_[next_] = round_trip;
  next_ = (next_ + 1) % capacity_;
}

absl::Duration RoundTrips::Quantile(double fraction) const {
  if (samples_.empty()) return absl::ZeroDuration();
  std::vector<absl::Duration> sorted = samples_;
  const double last = static_cast<double>(sorted.size() - 1);
  const auto rank =
      static_cast<size_t>(std::lround(std::clamp(fraction, 0.0, 1.0) * last));
  std::nth_element(sorted.begin(), sorted.begin() + rank, sorted.end());
  return sorted[rank];
}

}  // namespace gelenk::client
