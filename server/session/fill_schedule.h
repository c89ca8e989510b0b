// When a session is to be asked for what stands for frames that do not come.
//
// The first time one interval after the last frame came, then after each
// interval until nothing changes any more. Pure: all times come in.
#ifndef GELENK_SERVER_SESSION_FILL_SCHEDULE_H_
#define GELENK_SERVER_SESSION_FILL_SCHEDULE_H_

#include <optional>

#include "absl/time/time.h"

namespace gelenk::server {

class FillSchedule {
 public:
  // A pose whose numbers (m, rad, quaternions) change by no more a second
  // stands still.
  static constexpr double kStillSpeed = 1e-3;
  // What follows a source that has come to its end, feet that settle or a
  // filter, gets so long.
  static constexpr absl::Duration kSettling = absl::Seconds(1);

  // Of zero: never.
  explicit FillSchedule(absl::Duration interval) : interval_(interval) {}

  bool is_on() const { return interval_ > absl::ZeroDuration(); }
  // Unset: not before the next frame.
  std::optional<absl::Time> next() const { return next_; }

  // A frame was taken, or the session goes on where it was elsewhere.
  void Begin(absl::Time now);
  // A frame came too late to be taken: its source is alive. Only puts off what
  // there is to come.
  void PutOff(absl::Time now);
  // The session was asked: whether its source has settled, and by how much the
  // largest number of its pose changed since it was asked before.
  void Note(absl::Time now, bool is_settled, double change);
  void Stop() { next_.reset(); }

 private:
  absl::Duration interval_;
  std::optional<absl::Time> next_;
  // Ends then, at the latest.
  absl::Time moving_until_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_FILL_SCHEDULE_H_
