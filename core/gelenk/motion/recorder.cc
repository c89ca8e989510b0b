#include "gelenk/motion/recorder.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

// The frame time of evenly spaced times that start at 0; else 0.
double EvenFrameTime(const std::vector<double>& times_s) {
  if (times_s.size() < 2) return 0;
  const double frame_s =
      times_s.back() / static_cast<double>(times_s.size() - 1);
  for (size_t i = 0; i < times_s.size(); ++i) {
    const double expected_s = static_cast<double>(i) * frame_s;
    if (std::abs(times_s[i] - expected_s) > kEvenFrames * frame_s) return 0;
  }
  return frame_s;
}

}  // namespace

Recorder::Recorder(std::shared_ptr<const Skeleton> skeleton, int max_frames)
    : skeleton_(std::move(skeleton)), max_frames_(max_frames) {}

double Recorder::duration_s() const {
  return times_s_.empty() ? 0 : times_s_.back() - times_s_.front();
}

size_t Recorder::ByteSize() const {
  return sizeof(Recorder) +
         (times_s_.capacity() + positions_.capacity()) * sizeof(double);
}

absl::Status Recorder::Record(double time_s, const ConstVectorView& positions) {
  if (frame_count() >= max_frames_) {
    return absl::ResourceExhaustedError(
        absl::StrFormat("frames: want at most %d in a recording", max_frames_));
  }
  Violations violations;
  if (!std::isfinite(time_s) ||
      (!times_s_.empty() && time_s <= times_s_.back())) {
    violations.Add("time_s",
                   absl::StrFormat(
                       "want a finite time after the last, %.17g, got %.17g",
                       times_s_.empty() ? -INFINITY : times_s_.back(), time_s));
  }
  Eigen::VectorXd checked = positions;
  violations.AddStatus("", CheckPositions(*skeleton_, checked));
  if (!violations.empty()) return violations.ToStatus();
  times_s_.push_back(time_s);
  positions_.insert(positions_.end(), checked.begin(), checked.end());
  return absl::OkStatus();
}

absl::StatusOr<MotionClip> Recorder::ToClip(std::string name,
                                            Interpolation interpolation) const {
  if (times_s_.empty()) {
    return absl::FailedPreconditionError("frames: nothing is recorded");
  }
  std::vector<double> times_s = times_s_;
  for (double& time_s : times_s) time_s -= times_s_.front();
  const Eigen::Map<const Eigen::MatrixXd> frames(
      positions_.data(), skeleton_->position_count(), frame_count());
  std::vector<JointTrack> tracks;
  for (const PosePart& part : PosePartsOf(*skeleton_)) {
    tracks.push_back({.joint = part.joint,
                      .kind = part.kind,
                      .interpolation = interpolation,
                      .times_s = times_s,
                      .values = frames.middleRows(part.position_offset,
                                                  part.position_count)});
  }
  return MotionClip::Create(
      skeleton_, std::move(tracks),
      {.name = std::move(name), .frame_time_s = EvenFrameTime(times_s)});
}

}  // namespace gelenk
