// Clips of two objects of the same skeleton, brought together.
#ifndef GELENK_MOTION_CLIP_SKELETON_H_
#define GELENK_MOTION_CLIP_SKELETON_H_

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Two files of one rig differ by rounding at most.
inline constexpr double kSamePlaceM = 1e-3;
inline constexpr double kSameTurnRad = 1e-3;

// OK where a pose means the same on both: the same joints in the same order, of
// the same kinds, below the same parents, at the same places. INVALID_ARGUMENT
// listing what of `skeleton` is not as in `wanted`, as "joints[3]: ...". Cost:
// linear.
absl::Status CheckSameJoints(const Skeleton& skeleton, const Skeleton& wanted);

// `clip` as one of `skeleton`; errors as above.
absl::StatusOr<MotionClip> OnSkeleton(const MotionClip& clip,
                                      std::shared_ptr<const Skeleton> skeleton);

}  // namespace gelenk

#endif  // GELENK_MOTION_CLIP_SKELETON_H_
