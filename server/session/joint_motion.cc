#include "server/session/joint_motion.h"

#include "absl/strings/str_cat.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk::server {

void CheckMotion(const Skeleton& skeleton, const JointMotion& motion,
                 Violations& violations) {
  if (!motion.capture_time) return;
  if (motion.velocity.size() == skeleton.velocity_count() &&
      motion.velocity.allFinite()) {
    return;
  }
  violations.Add("velocity",
                 absl::StrCat("want ", skeleton.velocity_count(),
                              " finite numbers, got ", motion.velocity.size()));
}

bool BoundSpeed(const Skeleton& skeleton, const JointMotion& motion,
                std::optional<absl::Duration> capture_time,
                StepBounds& bounds) {
  if (!capture_time || !motion.capture_time) return false;
  SpeedLimits(skeleton, *capture_time - *motion.capture_time, motion.velocity,
              bounds);
  return true;
}

void NoteMotion(const Skeleton& skeleton,
                std::optional<absl::Duration> capture_time,
                const ConstVectorView& before, const ConstVectorView& after,
                JointMotion& motion) {
  const std::optional<absl::Duration> last = motion.capture_time;
  motion.velocity.setZero(skeleton.velocity_count());
  motion.capture_time = capture_time;
  if (!last || !capture_time || *capture_time <= *last) return;
  Difference(skeleton, before, after, motion.velocity);
  motion.velocity /= absl::ToDoubleSeconds(*capture_time - *last);
}

}  // namespace gelenk::server
