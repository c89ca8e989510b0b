// Keeps one foot where it stands, over a whole clip: with look-ahead nothing
// has to wait, and every contact has one place from its beginning to its end.
//
// The place of a contact is the mean of where the point would be. Heel and ball
// that stand together keep the foot's length and its mean direction. What that
// moves and turns fades out and in over the gaps between contacts.
#ifndef GELENK_RETARGET_FOOT_PLAN_H_
#define GELENK_RETARGET_FOOT_PLAN_H_

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/retarget/foot_planter.h"

namespace gelenk {

struct PlannedFoot {
  std::vector<FootPose> feet;
  std::vector<Eigen::Quaterniond> toes;
};

// `goals` and `toes` are those of the copied pose, by frame, `contacts` of this
// foot; `size` as BodyModel::Size of the target. All as long. Cost: linear.
PlannedFoot PlanFoot(
    const FootOnGround& foot, double size, double frame_time_s,
    absl::Span<const FootPose> goals, absl::Span<const Eigen::Quaterniond> toes,
    absl::Span<const std::array<Contact, kFootPointCount>> contacts);

}  // namespace gelenk

#endif  // GELENK_RETARGET_FOOT_PLAN_H_
