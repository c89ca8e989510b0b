// The numbers of q that belong together: those that add, or one quaternion.
//
// Motion over time treats the two differently: numbers are interpolated and
// filtered as they are, rotations on their manifold. A free joint has both.
#ifndef GELENK_MOTION_POSE_PART_H_
#define GELENK_MOTION_POSE_PART_H_

#include <optional>
#include <vector>

#include "absl/strings/string_view.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

enum class PosePartKind {
  kNumbers,   // angles, displacements, the translation of a free joint
  kRotation,  // x y z w of a spherical or free joint
};

absl::string_view PosePartKindName(PosePartKind kind);

struct PosePart {
  int joint = -1;
  PosePartKind kind = PosePartKind::kNumbers;
  // First number in q and how many; first number in a velocity and how many.
  int position_offset = 0;
  int position_count = 0;
  int velocity_offset = 0;
  int velocity_count = 0;
};

// Unset where the joint has no such numbers of its own (a mimic has none).
std::optional<PosePart> FindPosePart(const Skeleton& skeleton, int joint,
                                     PosePartKind kind);

// All of a skeleton, in the order of q.
std::vector<PosePart> PosePartsOf(const Skeleton& skeleton);

}  // namespace gelenk

#endif  // GELENK_MOTION_POSE_PART_H_
