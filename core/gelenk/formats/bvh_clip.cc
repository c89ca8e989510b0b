#include "gelenk/formats/bvh_clip.h"

#include <utility>

#include "gelenk/formats/bvh_motion.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk {

absl::StatusOr<MotionClip> ClipFromBvh(const BvhDocument& document,
                                       const BvhImport& import,
                                       std::string name) {
  const absl::StatusOr<Eigen::MatrixXd> poses = PosesFromBvh(document, import);
  if (!poses.ok()) return poses.status();
  return ClipFromFrames(
      import.skeleton, *poses,
      {.name = std::move(name), .frame_time_s = document.frame_time_s});
}

absl::StatusOr<BvhDocument> BvhFromClip(const BvhDocument& form,
                                        const BvhImport& import,
                                        const MotionClip& clip) {
  const double own_s = clip.properties().frame_time_s;
  const double frame_time_s = own_s > 0 ? own_s : form.frame_time_s;
  const absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(clip, frame_time_s);
  if (!frames.ok()) return frames.status();
  absl::StatusOr<BvhDocument> document = BvhFromPoses(form, import, *frames);
  if (document.ok()) document->frame_time_s = frame_time_s;
  return document;
}

}  // namespace gelenk
