#include "server/session/fill_schedule.h"

namespace gelenk::server {

void FillSchedule::Begin(absl::Time now) {
  if (!is_on()) return;
  next_ = now + interval_;
  moving_until_ = now + kSettling;
}

void FillSchedule::PutOff(absl::Time now) {
  if (next_) next_ = now + interval_;
}

void FillSchedule::Note(absl::Time now, bool is_settled, double change) {
  if (!is_settled) moving_until_ = now + kSettling;
  const bool is_still =
      is_settled && change <= kStillSpeed * absl::ToDoubleSeconds(interval_);
  next_.reset();
  if (!is_still && now < moving_until_) next_ = now + interval_;
}

}  // namespace gelenk::server
