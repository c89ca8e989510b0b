// Clips on top of each other, from the bottom up.
//
// A normal layer takes each joint from the pose below to its own by its weight
// times the joint's mask, along the shortest turn: weights that fade make a
// cross-fade, masks an arm that waves on a body that walks. An additive layer
// plays a difference clip (see difference_clip.h): what that does from the
// neutral pose is done to the pose below, times the weight, which may be any
// number.
//
// Below the lowest layer is the rest pose. Sampling allocates nothing.
#ifndef GELENK_MOTION_LAYER_STACK_H_
#define GELENK_MOTION_LAYER_STACK_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/motion/sampler.h"
#include "gelenk/motion/weight_curve.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

struct ClipLayer {
  enum class Kind { kNormal, kAdditive };

  MotionClip clip;
  Kind kind = Kind::kNormal;
  // Over the stack's time; in [0, 1] for a normal layer.
  WeightCurve weight = 1;
  // Per joint, in [0, 1]; empty means 1 everywhere.
  std::vector<double> joint_weights = {};
  // The stack's time at which the clip starts, and how fast it plays, which may
  // be backwards.
  double start_s = 0;
  double speed = 1;
  PlaybackMode mode = PlaybackMode::kClamp;
};

// Joint weights of 1 for `joint` and all below it, 0 elsewhere.
std::vector<double> MaskBelow(const Skeleton& skeleton, int joint);

class LayerStack {
 public:
  // All clips are of `skeleton` (the same object). INVALID_ARGUMENT listing
  // what is not, as "layers[1].joint_weights[4]: ...".
  static absl::StatusOr<LayerStack> Create(
      std::shared_ptr<const Skeleton> skeleton, std::vector<ClipLayer> layers);

  // The pose at `time_s`, finite.
  void Sample(double time_s, VectorView positions);

  int layer_count() const { return static_cast<int>(layers_.size()); }

  // When all layers that play forwards in clamp mode have ended, s.
  double end_s() const { return end_s_; }

 private:
  struct Layer {
    ClipLayer layer;
    Sampler sampler;
  };

  explicit LayerStack(std::shared_ptr<const Skeleton> skeleton);
  void Put(const ClipLayer& layer, double weight, VectorView positions) const;

  std::shared_ptr<const Skeleton> skeleton_;
  std::vector<PosePart> parts_;
  std::vector<Layer> layers_;
  double end_s_ = 0;
  Eigen::VectorXd pose_;
};

// A stack as a clip of frames at `frame_time_s` from 0 to `duration_s`.
absl::StatusOr<MotionClip> ClipFromLayers(
    LayerStack stack, std::shared_ptr<const Skeleton> skeleton,
    double duration_s, ClipProperties properties);

// `first`, then `second` from `start_s` on, with `fade_s` from one to the
// other. INVALID_ARGUMENT for other skeletons or times.
absl::StatusOr<MotionClip> CrossFade(const MotionClip& first,
                                     const MotionClip& second, double start_s,
                                     double fade_s);

}  // namespace gelenk

#endif  // GELENK_MOTION_LAYER_STACK_H_
