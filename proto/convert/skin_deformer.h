// How a skin is deformed, between the contract and the core.
#ifndef GELENK_CONVERT_SKIN_DEFORMER_H_
#define GELENK_CONVERT_SKIN_DEFORMER_H_

#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/skin_link.h"
#include "gelenk/skin/volume_rig.h"
#include "gelenk/skin/weighted_skin.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::convert {

// All but muscles and assignments. Unchecked: VolumeRig does.
SkinLinkOptions FromProto(const v1::LayeredVolumes& proto);

struct WeightsOfJoints {
  SkinWeights weights;
  // As WeightedSkin::Options has it.
  std::vector<WeightedSkin::Affine> joint_from_mesh;
};
// INVALID_ARGUMENT for joints that are unknown or named twice, indices out of
// range, and matrices of a number that does not fit; the rest is unchecked:
// WeightedSkin does.
absl::StatusOr<WeightsOfJoints> FromProto(const Skeleton& skeleton,
                                          const v1::VertexWeights& proto);

// The link `index` of `rig`.
void ToProto(const VolumeRig& rig, int index, v1::SkinLink* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_SKIN_DEFORMER_H_
