#include "server/session/session_recording.h"

namespace gelenk::server {

void SessionRecording::Note(std::optional<absl::Duration> capture_time,
                            absl::Time now, const ConstVectorView& positions) {
  if (recorder_.frame_count() == 0) {
    by_capture_time_ = capture_time.has_value();
  }
  if (by_capture_time_ && !capture_time) {
    ++left_out_;
    return;
  }
  const double time_s = absl::ToDoubleSeconds(
      by_capture_time_ ? *capture_time : now - absl::UnixEpoch());
  if (!recorder_.Record(time_s, positions).ok()) ++left_out_;
}

}  // namespace gelenk::server
