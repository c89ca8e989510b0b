// The weighted mean of several poses.
//
// Numbers: their mean. Rotations: the one from which the weighted turns to all
// others cancel (Karcher's mean), so that neither the order of the poses nor a
// choice of frame matters; of two it is the point on the shortest turn between
// them. Joints in whose sight all weights are zero keep what they have.
//
// Limit: the rotations of a joint lie within half a turn of each other, else
// their mean is not unique (the one found is near that of the largest weight).
#ifndef GELENK_MOTION_BLENDER_H_
#define GELENK_MOTION_BLENDER_H_

#include <memory>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// One pose that takes part.
struct BlendInput {
  // position_count numbers.
  const double* positions = nullptr;
  // >= 0; only ratios matter.
  double weight = 1;
  // Per joint a factor >= 0 on the weight; empty means 1 everywhere.
  absl::Span<const double> joint_weights = {};
};

class Blender {
 public:
  explicit Blender(std::shared_ptr<const Skeleton> skeleton);

  // Into `positions`, which holds a pose. A pose that is alone, or alike in all
  // inputs, comes out as it went in. Allocates nothing.
  void Blend(absl::Span<const BlendInput> inputs, VectorView positions) const;

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  std::vector<PosePart> parts_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_BLENDER_H_
