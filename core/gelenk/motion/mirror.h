// Left becomes right: which joints are each other's mirror images, and a motion
// seen in the mirror.
//
// Works whatever the joints' frames: in the world every joint turns as its
// partner's image does. With M_w the world's mirror, M_r that of the rest pose
// and W_j the frame of joint j, the partner m of j gets
//   W'_m = M_w W_j (W_j at rest)^-1 M_r (W_m at rest),
// which is the rest pose where j rests. Mirroring twice gives the motion back.
#ifndef GELENK_MOTION_MIRROR_H_
#define GELENK_MOTION_MIRROR_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct MirrorMap {
  // Per joint its image; itself for those in the middle.
  std::vector<int> partner = {};
  // Unit: across the plane in which the rest pose is symmetric, and across the
  // vertical plane through the world's origin in which motions are mirrored.
  Eigen::Vector3d rest_normal = Eigen::Vector3d::UnitX();
  Eigen::Vector3d world_normal = Eigen::Vector3d::UnitX();
  // What told left from right: names, or the rest pose.
  bool by_names = true;
  // How far a joint at rest is from its partner's image at worst, m.
  double symmetry_error_m = 0;
  // Joints of one side (by name) without a partner; they stay in place.
  std::vector<int> unpaired = {};
  // Hinges and sliders whose axis is not their partner's image: their motion is
  // only near.
  std::vector<int> skewed = {};
};

// The names that `id` has on the other side, as the common rigs have it:
// LeftHand, hand_l, lHand, "Bip01 L Hand", Hand.L; likeliest first.
std::vector<std::string> OtherSideNames(absl::string_view id);

// By names, and where these name no pair by the rest pose. FAILED_PRECONDITION
// when neither tells one.
absl::StatusOr<MirrorMap> FindMirrorMap(const Skeleton& skeleton);

// One pose; `mirrored` is another vector.
void MirrorPose(const Skeleton& skeleton, const MirrorMap& map,
                const ConstVectorView& positions, VectorView mirrored);

// The clip as frames at its frame time, mirrored. INVALID_ARGUMENT where `map`
// is of another skeleton.
absl::StatusOr<MotionClip> MirrorClip(const MotionClip& clip,
                                      const MirrorMap& map);

}  // namespace gelenk

#endif  // GELENK_MOTION_MIRROR_H_
