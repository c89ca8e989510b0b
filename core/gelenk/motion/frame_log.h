// What a session did, frame by frame, so that it can be done again.
//
// Keeps for each frame its number, when it was captured, what was in it once
// everything kept from earlier frames is filled in, and the pose that came out.
// `Input` is any value; a replay feeds them in order to the same code and
// compares poses, bit by bit where the code is deterministic.
#ifndef GELENK_MOTION_FRAME_LOG_H_
#define GELENK_MOTION_FRAME_LOG_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Whether both are the same numbers in the same bits: 0 is not -0 here.
inline bool HasSameBits(const ConstVectorView& a, const ConstVectorView& b) {
  return a.size() == b.size() &&
         (a.size() == 0 ||
          std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

template <class Input>
struct LoggedFrame {
  int64_t sequence_number = 0;
  double time_s = 0;
  Input input;
  Eigen::VectorXd positions;
};

template <class Input>
class FrameLog {
 public:
  // At most `max_frames`; after that Append is refused.
  explicit FrameLog(size_t max_frames) : max_frames_(max_frames) {}

  // INVALID_ARGUMENT unless the number grows; RESOURCE_EXHAUSTED when full.
  absl::Status Append(LoggedFrame<Input> frame) {
    if (frames_.size() >= max_frames_) {
      return absl::ResourceExhaustedError(
          absl::StrFormat("frames: want at most %d in a log", max_frames_));
    }
    if (!frames_.empty() &&
        frame.sequence_number <= frames_.back().sequence_number) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "sequence_number: want more than the last, %d, got %d",
          frames_.back().sequence_number, frame.sequence_number));
    }
    frames_.push_back(std::move(frame));
    return absl::OkStatus();
  }

  const std::vector<LoggedFrame<Input>>& frames() const { return frames_; }

  // Calls `step(frame) -> Eigen::VectorXd` for each and returns the index of
  // the first whose pose is another by more than `tolerance` in any number, -1
  // where all are the same. 0 means bit by bit.
  template <class Step>
  int Replay(Step step, double tolerance = 0) const {
    for (size_t i = 0; i < frames_.size(); ++i) {
      const Eigen::VectorXd positions = step(frames_[i]);
      const Eigen::VectorXd& logged = frames_[i].positions;
      if (!IsNear(positions, logged, tolerance)) return static_cast<int>(i);
    }
    return -1;
  }

 private:
  static bool IsNear(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                     double tolerance) {
    if (tolerance == 0) return HasSameBits(a, b);
    // NaN fails the comparison.
    return a.size() == b.size() &&
           (a.size() == 0 || (a - b).cwiseAbs().maxCoeff() <= tolerance);
  }

  size_t max_frames_;
  std::vector<LoggedFrame<Input>> frames_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_FRAME_LOG_H_
