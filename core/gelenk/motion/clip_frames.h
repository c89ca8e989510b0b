// Clips and evenly spaced frames: one pose a column, frame k at k times the
// frame time.
#ifndef GELENK_MOTION_CLIP_FRAMES_H_
#define GELENK_MOTION_CLIP_FRAMES_H_

#include <Eigen/Core>
#include <memory>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Most frames that a clip is sampled into: over two hours at 120 Hz.
inline constexpr int kMaxClipFrames = 1'000'000;

// A key per frame and part. `properties.frame_time_s` is the frame time, > 0.
// `frames` has position_count rows and at least one column; quaternions near
// unit. INVALID_ARGUMENT lists what is malformed, as "frames[3][7]".
absl::StatusOr<MotionClip> ClipFromFrames(
    std::shared_ptr<const Skeleton> skeleton, const Eigen::MatrixXd& frames,
    ClipProperties properties,
    Interpolation interpolation = Interpolation::kLinear);

// The clip at 0, frame_time_s, ... up to its duration: the last frame is the
// last within a thousandth of a frame after the end. Frames of a clip made by
// ClipFromFrames come back bit by bit. Quaternions lie in the hemisphere of the
// frame before. INVALID_ARGUMENT unless frame_time_s > 0 and there are at most
// kMaxClipFrames.
absl::StatusOr<Eigen::MatrixXd> FramesFromClip(const MotionClip& clip,
                                               double frame_time_s);

// At the clip's own frame time; a clip without one is sampled at
// kDefaultFrameTime_s.
inline constexpr double kDefaultFrameTime_s = 1.0 / 60;
double FrameTimeOf(const MotionClip& clip);
absl::StatusOr<Eigen::MatrixXd> FramesFromClip(const MotionClip& clip);

}  // namespace gelenk

#endif  // GELENK_MOTION_CLIP_FRAMES_H_
