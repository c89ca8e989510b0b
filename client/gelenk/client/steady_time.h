// The clock of waits and round trips: monotonic, unrelated to the calendar.
#ifndef GELENK_CLIENT_STEADY_TIME_H_
#define GELENK_CLIENT_STEADY_TIME_H_

#include <algorithm>
#include <chrono>

#include "absl/time/time.h"

namespace gelenk::client {

using SteadyTime = std::chrono::steady_clock::time_point;

// `start + duration`; beyond a year (InfiniteDuration too) means in a year.
inline SteadyTime After(SteadyTime start, absl::Duration duration) {
  return start +
         absl::ToChronoNanoseconds(std::min(duration, absl::Hours(24 * 365)));
}

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_STEADY_TIME_H_
