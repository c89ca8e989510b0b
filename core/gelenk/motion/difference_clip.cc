#include "gelenk/motion/difference_clip.h"

#include <utility>

#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/sampler.h"

namespace gelenk {

absl::StatusOr<MotionClip> DifferenceClip(const MotionClip& clip,
                                          const ConstVectorView& base_pose) {
  absl::StatusOr<MotionClip> base =
      MotionClip::Create(clip.skeleton(), {}, {.base_positions = base_pose});
  if (!base.ok()) return base.status();
  return DifferenceClip(clip, *base);
}

absl::StatusOr<MotionClip> DifferenceClip(const MotionClip& clip,
                                          const MotionClip& base) {
  if (clip.skeleton() != base.skeleton()) {
    return absl::InvalidArgumentError("base: is of another skeleton");
  }
  const double frame_time_s = FrameTimeOf(clip);
  absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(clip, frame_time_s);
  if (!frames.ok()) return frames.status();
  const Skeleton& skeleton = *clip.skeleton();
  const Eigen::VectorXd neutral = NeutralPositions(skeleton);
  Sampler sampler(base);
  Eigen::VectorXd from = neutral;
  Eigen::VectorXd change(skeleton.velocity_count());
  for (Eigen::Index i = 0; i < frames->cols(); ++i) {
    sampler.Sample(static_cast<double>(i) * frame_time_s, from);
    Difference(skeleton, from, frames->col(i), change);
    Integrate(skeleton, neutral, change, frames->col(i));
  }
  return ClipFromFrames(clip.skeleton(), *frames,
                        {.name = clip.name(),
                         .frame_time_s = frame_time_s,
                         .seam_s = clip.properties().seam_s,
                         .base_positions = neutral});
}

}  // namespace gelenk
