#include "gelenk/motion/low_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "absl/strings/str_format.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

// Half power after two passes instead of one: (sqrt(2) - 1)^(1/4).
constexpr double kTwoPasses = 0.8022432629231502;

// The filter has forgotten its start after so many times 1 / cutoff.
constexpr double kSettling = 2;

struct Coefficients {
  double b0, b1, b2, a2;
};

// Second order by the bilinear transform; a1 follows from the others.
Coefficients Butterworth(double cutoff_of_rate) {
  const double k = std::tan(std::numbers::pi * cutoff_of_rate);
  const double scale = 1 / (1 + std::numbers::sqrt2 * k + k * k);
  return {k * k * scale, 2 * k * k * scale, k * k * scale,
          (1 - std::numbers::sqrt2 * k + k * k) * scale};
}

// Adds whole turns to the rotations of `change`, as many as bring each next to
// `course`: a filter that lags behind a fast turn is on its own side of it,
// also by more than half a turn.
void Unwind(const std::vector<PosePart>& parts, const Eigen::VectorXd& course,
            Eigen::VectorXd& change) {
  for (const PosePart& part : parts) {
    if (part.kind != PosePartKind::kRotation) continue;
    auto turn = change.segment<3>(part.velocity_offset);
    const double angle = turn.norm();
    if (angle == 0) continue;
    const double along =
        course.segment<3>(part.velocity_offset).dot(turn) / angle;
    const double turns = std::round((along - angle) / (2 * std::numbers::pi));
    turn *= 1 + turns * 2 * std::numbers::pi / angle;
  }
}

// In place, from the first column to the last.
void Filter(const Skeleton& skeleton, const Coefficients& c,
            Eigen::MatrixXd& frames) {
  const std::vector<PosePart> parts = PosePartsOf(skeleton);
  Eigen::VectorXd x1 = frames.col(0), x2 = x1, y1 = x1, y2 = x1, x;
  // From y1 to x1, x2, x and y2; the last one to x is the course of the next.
  Eigen::VectorXd to_x = Eigen::VectorXd::Zero(skeleton.velocity_count());
  Eigen::VectorXd to_x1 = to_x, to_x2 = to_x, to_y2 = to_x, step = to_x;
  for (Eigen::Index i = 0; i < frames.cols(); ++i) {
    x = frames.col(i);
    Difference(skeleton, y1, x1, to_x1);
    Unwind(parts, to_x, to_x1);
    Difference(skeleton, y1, x2, to_x2);
    Unwind(parts, to_x1, to_x2);
    Difference(skeleton, y1, x, to_x);
    Unwind(parts, to_x1, to_x);
    Difference(skeleton, y1, y2, to_y2);
    step = c.b0 * to_x + c.b1 * to_x1 + c.b2 * to_x2 - c.a2 * to_y2;
    y2 = y1;
    Integrate(skeleton, y2, step, y1);
    x2 = x1;
    x1 = x;
    frames.col(i) = y1;
  }
}

// `pose` on the other side of `center`.
Eigen::VectorXd Reflected(const Skeleton& skeleton,
                          const Eigen::VectorXd& center,
                          const Eigen::VectorXd& pose) {
  Eigen::VectorXd change(skeleton.velocity_count());
  Difference(skeleton, pose, center, change);
  Eigen::VectorXd reflected = center;
  Integrate(skeleton, center, change, reflected);
  return reflected;
}

}  // namespace

absl::StatusOr<Eigen::MatrixXd> LowPass(const Skeleton& skeleton,
                                        const Eigen::MatrixXd& frames,
                                        double frame_time_s, double cutoff_hz) {
  if (!(std::isfinite(frame_time_s) && frame_time_s > 0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "frame_time_s: want a finite number > 0, got %g", frame_time_s));
  }
  if (!(cutoff_hz > 0 && cutoff_hz * frame_time_s < kMaxCutoffPart)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "cutoff_hz: want more than 0 and less than %g of the frame rate, %g, "
        "got %g",
        kMaxCutoffPart, kMaxCutoffPart / frame_time_s, cutoff_hz));
  }
  if (frames.rows() != skeleton.position_count()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("frames: want %d numbers each, got %d",
                        skeleton.position_count(), frames.rows()));
  }
  const Eigen::Index count = frames.cols();
  if (count < 2) return frames;
  const double settling = std::ceil(kSettling / (cutoff_hz * frame_time_s));
  const Eigen::Index padding = static_cast<Eigen::Index>(
      std::min(settling, static_cast<double>(count - 1)));
  Eigen::MatrixXd padded(frames.rows(), count + 2 * padding);
  padded.middleCols(padding, count) = frames;
  for (Eigen::Index i = 1; i <= padding; ++i) {
    padded.col(padding - i) = Reflected(skeleton, frames.col(0), frames.col(i));
    padded.col(padding + count - 1 + i) =
        Reflected(skeleton, frames.col(count - 1), frames.col(count - 1 - i));
  }
  // Prewarped: the bilinear transform bends the axis of frequencies.
  const double omega =
      std::tan(std::numbers::pi * cutoff_hz * frame_time_s) / kTwoPasses;
  const Coefficients coefficients =
      Butterworth(std::atan(omega) / std::numbers::pi);
  for (int pass = 0; pass < 2; ++pass) {
    Filter(skeleton, coefficients, padded);
    padded.rowwise().reverseInPlace();
  }
  Eigen::MatrixXd result = padded.middleCols(padding, count);
  for (Eigen::Index i = 1; i < count; ++i) {
    AlignHemispheres(skeleton, result.col(i - 1), result.col(i));
  }
  return result;
}

absl::StatusOr<MotionClip> LowPassClip(const MotionClip& clip,
                                       double cutoff_hz) {
  const absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(clip);
  if (!frames.ok()) return frames.status();
  const double frame_time_s = FrameTimeOf(clip);
  const absl::StatusOr<Eigen::MatrixXd> smooth =
      LowPass(*clip.skeleton(), *frames, frame_time_s, cutoff_hz);
  if (!smooth.ok()) return smooth.status();
  ClipProperties properties = clip.properties();
  properties.frame_time_s = frame_time_s;
  return ClipFromFrames(clip.skeleton(), *smooth, std::move(properties));
}

}  // namespace gelenk
