// What a stream has been through.
#ifndef GELENK_CLIENT_STREAM_STATISTICS_H_
#define GELENK_CLIENT_STREAM_STATISTICS_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/time/time.h"

namespace gelenk::client {

// The newest times from Send to answer.
class RoundTrips {
 public:
  // Remembers `capacity` of them.
  explicit RoundTrips(size_t capacity = 1 << 14) : capacity_(capacity) {}

  void Add(absl::Duration round_trip);

  size_t size() const { return samples_.size(); }

  // `fraction` 0.5 is the median, 0.99 what one in a hundred exceeds; zero when
  // there is none. Sorts a copy.
  absl::Duration Quantile(double fraction) const;

 private:
  size_t capacity_;
  size_t next_ = 0;
  std::vector<absl::Duration> samples_;
};

struct StreamStatistics {
  int64_t sent_frames = 0;
  int64_t answered_frames = 0;
  // Sent more than once, because the answer was lost.
  int64_t resent_frames = 0;
  // Merged into a newer one before they were sent (LATEST_WINS).
  int64_t merged_frames = 0;
  // Connections after the first.
  int64_t reconnects = 0;
  // Sessions that were gone and were made again.
  int64_t recreated_sessions = 0;
  // Resumes of which the server said that they are not exact.
  int64_t inexact_resumes = 0;
  RoundTrips round_trips;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_STREAM_STATISTICS_H_
