#include "gelenk/motion/pose_part.h"

namespace gelenk {

absl::string_view PosePartKindName(PosePartKind kind) {
  return kind == PosePartKind::kNumbers ? "numbers" : "rotation";
}

std::optional<PosePart> FindPosePart(const Skeleton& skeleton, int joint,
                                     PosePartKind kind) {
  const JointSpan& span = skeleton.span(joint);
  if (span.position_offset < 0) return std::nullopt;
  const bool has_rotation = span.quaternion_offset >= 0;
  const int numbers = has_rotation
                          ? span.quaternion_offset - span.position_offset
                          : PositionCount(skeleton.joint(joint).type);
  if (kind == PosePartKind::kNumbers) {
    if (numbers == 0) return std::nullopt;
    return PosePart{
        joint,  kind, span.position_offset, numbers, span.velocity_offset,
        numbers};
  }
  if (!has_rotation) return std::nullopt;
  return PosePart{
      joint, kind, span.quaternion_offset, 4, span.velocity_offset + numbers,
      3};
}

std::vector<PosePart> PosePartsOf(const Skeleton& skeleton) {
  std::vector<PosePart> parts;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    for (PosePartKind kind :
         {PosePartKind::kNumbers, PosePartKind::kRotation}) {
      const std::optional<PosePart> part = FindPosePart(skeleton, joint, kind);
      if (part) parts.push_back(*part);
    }
  }
  return parts;
}

}  // namespace gelenk
