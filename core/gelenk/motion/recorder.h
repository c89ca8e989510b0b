// Collects poses as they come into a clip.
//
// Times are those of the poses, whatever the rate: the clip starts at the first
// and has a key per pose and part. Memory is bounded. A value: a copy goes on
// by itself.
#ifndef GELENK_MOTION_RECORDER_H_
#define GELENK_MOTION_RECORDER_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Of one recording unless told otherwise: a quarter of an hour at 120 Hz.
inline constexpr int kDefaultMaxRecordedFrames = 108'000;

class Recorder {
 public:
  explicit Recorder(std::shared_ptr<const Skeleton> skeleton,
                    int max_frames = kDefaultMaxRecordedFrames);

  // INVALID_ARGUMENT unless `time_s` is finite and later than the last and
  // CheckPositions takes the pose; RESOURCE_EXHAUSTED once max_frames are there
  // (what is recorded stays). State unchanged on error.
  absl::Status Record(double time_s, const ConstVectorView& positions);

  int frame_count() const { return static_cast<int>(times_s_.size()); }
  // From the first to the last pose.
  double duration_s() const;
  size_t ByteSize() const;

  // What is recorded so far. FAILED_PRECONDITION without a pose. Where the
  // times are evenly spaced to within kEvenFrames of a frame, that is the
  // clip's frame time.
  absl::StatusOr<MotionClip> ToClip(
      std::string name,
      Interpolation interpolation = Interpolation::kLinear) const;

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  int max_frames_;
  std::vector<double> times_s_;
  // Poses one after the other.
  std::vector<double> positions_;
};

inline constexpr double kEvenFrames = 1e-6;

}  // namespace gelenk

#endif  // GELENK_MOTION_RECORDER_H_
