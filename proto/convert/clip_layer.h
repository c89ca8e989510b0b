// Layers of clips, their weights and masks between the contract and the core.
#ifndef GELENK_CONVERT_CLIP_LAYER_H_
#define GELENK_CONVERT_CLIP_LAYER_H_

#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/layer_stack.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/motion/weight_curve.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/motion.pb.h"

namespace gelenk::convert {

// Unchecked; see WeightCurve::Check.
WeightCurve FromProto(const v1::WeightCurve& proto);

// A weight for each joint. INVALID_ARGUMENT naming the entries whose joint is
// not there; LayerStack::Create checks the weights.
absl::StatusOr<std::vector<double>> FromProto(const Skeleton& skeleton,
                                              const v1::JointMask& proto);

// `clip` is what `proto` names. INVALID_ARGUMENT for what the core's type
// cannot hold (mode, mask); LayerStack::Create checks the rest.
absl::StatusOr<ClipLayer> FromProto(const v1::ClipLayer& proto,
                                    MotionClip clip);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_CLIP_LAYER_H_
