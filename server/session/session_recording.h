// What a session produces, kept while somebody asks for it.
//
// Its times are those of the frames: the client's capture times where the first
// frame has one, else when poses came out. Not thread-safe: lives under the
// lock of its session.
#ifndef GELENK_SERVER_SESSION_SESSION_RECORDING_H_
#define GELENK_SERVER_SESSION_SESSION_RECORDING_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/motion/recorder.h"

namespace gelenk::server {

// Bytes under a limit, given back when it goes.
class ReservedBytes {
 public:
  ReservedBytes(std::atomic<int64_t>& held, int64_t bytes, int64_t limit)
      : held_(held), bytes_(bytes) {
    granted_ = (held_ += bytes_) <= limit;
  }
  ~ReservedBytes() { held_ -= bytes_; }
  ReservedBytes(const ReservedBytes&) = delete;
  ReservedBytes& operator=(const ReservedBytes&) = delete;

  bool granted() const { return granted_; }

 private:
  std::atomic<int64_t>& held_;
  const int64_t bytes_;
  bool granted_;
};

class SessionRecording {
 public:
  // `bytes` pays for `max_frames` poses.
  SessionRecording(std::shared_ptr<const Skeleton> skeleton, int max_frames,
                   std::unique_ptr<ReservedBytes> bytes)
      : recorder_(std::move(skeleton), max_frames), bytes_(std::move(bytes)) {}

  // Takes a pose that came out at `now`. One whose time does not follow the one
  // before, or comes when the recording is full, is left out and counted.
  void Note(std::optional<absl::Duration> capture_time, absl::Time now,
            const ConstVectorView& positions);

  // FAILED_PRECONDITION without a pose.
  absl::StatusOr<MotionClip> ToClip(const std::string& name) const {
    return recorder_.ToClip(name);
  }
  int64_t left_out_count() const { return left_out_; }

 private:
  Recorder recorder_;
  const std::unique_ptr<ReservedBytes> bytes_;
  bool by_capture_time_ = false;
  int64_t left_out_ = 0;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_SESSION_RECORDING_H_
