// Which joints of a chain are the shoulder and the elbow, or the hip and the
// knee, when the hand or the foot is known.
//
// Names alone mislead: a LeftUpLeg can be the buttock, a LeftShoulder the
// collar bone or the upper arm, a LeftHip the thigh or a helper. So every pair
// of joints is scored by the lengths that it makes of the limb, with the names
// as advice.
#ifndef GELENK_RETARGET_LIMB_FINDER_H_
#define GELENK_RETARGET_LIMB_FINDER_H_

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

enum class LimbKind { kArm, kLeg };

struct LimbJoints {
  int upper = -1;
  int middle = -1;
  // 0 is a limb of a textbook, kMaxLimbScore the worst that is taken; may be
  // negative where names agree.
  double score = 0;
};

// A pair that scores worse is no limb.
inline constexpr double kMaxLimbScore = 0.9;

// The joints from below `top` to `end`, both in the skeleton, `top` above
// `end`. `points` are the joints at rest. None without two bones of a limb's
// proportions. Cost: quadratic in the joints of the chain.
std::optional<LimbJoints> FindLimb(const Skeleton& skeleton,
                                   absl::Span<const Eigen::Vector3d> points,
                                   int top, int end, LimbKind kind);

// The joints from `top` (without it) down to `end` (with it); empty when `end`
// is not below `top`.
std::vector<int> ChainBelow(const Skeleton& skeleton, int top, int end);

}  // namespace gelenk

#endif  // GELENK_RETARGET_LIMB_FINDER_H_
