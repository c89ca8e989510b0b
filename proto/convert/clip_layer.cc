#include "convert/clip_layer.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/joint_track.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {

WeightCurve FromProto(const v1::WeightCurve& proto) {
  std::vector<WeightKey> keys;
  keys.reserve(proto.keys_size());
  for (const v1::WeightKey& key : proto.keys()) {
    keys.push_back({key.time_s(), key.weight()});
  }
  return WeightCurve(std::move(keys));
}

absl::StatusOr<std::vector<double>> FromProto(const Skeleton& skeleton,
                                              const v1::JointMask& proto) {
  Violations violations;
  std::vector<double> weights(skeleton.joint_count(), 0.0);
  for (int i = 0; i < proto.entries_size(); ++i) {
    const v1::MaskEntry& entry = proto.entries(i);
    const absl::StatusOr<int> joint = JointFromProto(
        absl::StrCat("entries[", i, "].joint_id"), skeleton, entry.joint_id());
    violations.AddStatus("", joint.status());
    if (!joint.ok()) continue;
    const double weight = entry.has_weight() ? entry.weight() : 1;
    weights[*joint] = weight;
    if (!entry.include_below()) continue;
    const std::vector<double> below = MaskBelow(skeleton, *joint);
    for (int k = 0; k < skeleton.joint_count(); ++k) {
      if (below[k] > 0) weights[k] = weight;
    }
  }
  if (!violations.empty()) return violations.ToStatus();
  return weights;
}

absl::StatusOr<ClipLayer> FromProto(const v1::ClipLayer& proto,
                                    MotionClip clip) {
  Violations violations;
  ClipLayer layer{.clip = std::move(clip)};
  switch (proto.mode()) {
    case v1::ClipLayer::MODE_UNSPECIFIED:
    case v1::ClipLayer::MODE_NORMAL:
      break;
    case v1::ClipLayer::MODE_ADDITIVE:
      layer.kind = ClipLayer::Kind::kAdditive;
      break;
    default:
      violations.Add("mode", absl::StrCat("no such mode: ",
                                          static_cast<int>(proto.mode())));
  }
  if (proto.has_weight()) layer.weight = FromProto(proto.weight());
  if (proto.has_mask()) {
    absl::StatusOr<std::vector<double>> mask =
        FromProto(*layer.clip.skeleton(), proto.mask());
    violations.AddStatus("mask", mask.status());
    if (mask.ok()) layer.joint_weights = *std::move(mask);
  }
  layer.start_s = proto.start_s();
  if (proto.has_speed()) layer.speed = proto.speed();
  if (proto.loop()) layer.mode = PlaybackMode::kLoop;
  if (!violations.empty()) return violations.ToStatus();
  return layer;
}

}  // namespace gelenk::convert
