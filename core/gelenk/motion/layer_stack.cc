#include "gelenk/motion/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/slerp.h"

namespace gelenk {
namespace {

void CheckLayer(const std::string& field, const Skeleton* skeleton,
                const ClipLayer& layer, Violations& violations) {
  if (layer.clip.skeleton().get() != skeleton) {
    violations.Add(field + ".clip", "is of another skeleton");
  }
  const bool is_normal = layer.kind == ClipLayer::Kind::kNormal;
  layer.weight.Check(field + ".weight", is_normal ? 0 : -INFINITY, violations);
  if (is_normal) {
    for (size_t i = 0; i < layer.weight.keys().size(); ++i) {
      const double weight = layer.weight.keys()[i].weight;
      if (!(weight > 1)) continue;
      violations.Add(absl::StrCat(field, ".weight[", i, "].weight"),
                     absl::StrCat("want at most 1, got ", weight));
    }
  }
  const size_t joints = skeleton->joint_count();
  if (!layer.joint_weights.empty() && layer.joint_weights.size() != joints) {
    violations.Add(field + ".joint_weights",
                   absl::StrFormat("want %d numbers or none, got %d", joints,
                                   layer.joint_weights.size()));
  }
  for (size_t i = 0; i < layer.joint_weights.size(); ++i) {
    const double weight = layer.joint_weights[i];
    if (weight >= 0 && weight <= 1) continue;
    violations.Add(absl::StrCat(field, ".joint_weights[", i, "]"),
                   absl::StrCat("want 0 to 1, got ", weight));
  }
  if (!std::isfinite(layer.start_s)) {
    violations.Add(field + ".start_s",
                   absl::StrCat("want a finite number, got ", layer.start_s));
  }
  if (!std::isfinite(layer.speed)) {
    violations.Add(field + ".speed",
                   absl::StrCat("want a finite number, got ", layer.speed));
  }
}

}  // namespace

std::vector<double> MaskBelow(const Skeleton& skeleton, int joint) {
  std::vector<double> weights(skeleton.joint_count(), 0);
  weights[joint] = 1;
  for (int i = joint + 1; i < skeleton.joint_count(); ++i) {
    const int parent = skeleton.span(i).parent;
    if (parent >= 0) weights[i] = weights[parent];
  }
  return weights;
}

LayerStack::LayerStack(std::shared_ptr<const Skeleton> skeleton)
    : skeleton_(std::move(skeleton)),
      parts_(PosePartsOf(*skeleton_)),
      pose_(skeleton_->rest_positions()) {}

absl::StatusOr<LayerStack> LayerStack::Create(
    std::shared_ptr<const Skeleton> skeleton, std::vector<ClipLayer> layers) {
  Violations violations;
  for (size_t i = 0; i < layers.size(); ++i) {
    CheckLayer(absl::StrCat("layers[", i, "]"), skeleton.get(), layers[i],
               violations);
  }
  if (!violations.empty()) return violations.ToStatus();
  LayerStack stack(std::move(skeleton));
  stack.layers_.reserve(layers.size());
  for (ClipLayer& layer : layers) {
    if (layer.speed > 0 && layer.mode == PlaybackMode::kClamp) {
      stack.end_s_ = std::max(
          stack.end_s_, layer.start_s + layer.clip.duration_s() / layer.speed);
    }
    Sampler sampler(layer.clip, layer.mode);
    stack.layers_.push_back({std::move(layer), std::move(sampler)});
  }
  return stack;
}

void LayerStack::Sample(double time_s, VectorView positions) {
  positions = skeleton_->rest_positions();
  for (Layer& layer : layers_) {
    const double weight = layer.layer.weight.At(time_s);
    if (weight == 0) continue;
    layer.sampler.Sample(layer.layer.speed * (time_s - layer.layer.start_s),
                         pose_);
    Put(layer.layer, weight, positions);
  }
}

void LayerStack::Put(const ClipLayer& layer, double weight,
                     VectorView positions) const {
  const bool is_normal = layer.kind == ClipLayer::Kind::kNormal;
  for (const PosePart& part : parts_) {
    const double w = layer.joint_weights.empty()
                         ? weight
                         : weight * layer.joint_weights[part.joint];
    if (w == 0) continue;
    double* below = positions.data() + part.position_offset;
    const double* own = pose_.data() + part.position_offset;
    if (is_normal && w == 1) {
      std::copy_n(own, part.position_count, below);
    } else if (part.kind == PosePartKind::kNumbers) {
      for (int i = 0; i < part.position_count; ++i) {
        below[i] += is_normal ? w * (own[i] - below[i]) : w * own[i];
      }
    } else if (is_normal) {
      StoreXyzw(Slerp(QuaternionXyzw(below), QuaternionXyzw(own), w), below);
    } else {
      StoreXyzw((QuaternionXyzw(below) *
                 ExpRotation(w * LogRotation(QuaternionXyzw(own))))
                    .normalized(),
                below);
    }
  }
}

absl::StatusOr<MotionClip> ClipFromLayers(
    LayerStack stack, std::shared_ptr<const Skeleton> skeleton,
    double duration_s, ClipProperties properties) {
  const double frame_time_s = properties.frame_time_s;
  const double steps = std::floor(duration_s / frame_time_s + 1e-3);
  if (!(frame_time_s > 0 && steps >= 0 && steps < kMaxClipFrames)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "duration_s: want 1 to %d frames of frame_time_s, got %g s of %g s",
        kMaxClipFrames, duration_s, frame_time_s));
  }
  Eigen::MatrixXd frames(skeleton->position_count(),
                         static_cast<Eigen::Index>(steps) + 1);
  for (Eigen::Index i = 0; i < frames.cols(); ++i) {
    stack.Sample(static_cast<double>(i) * frame_time_s, frames.col(i));
  }
  return ClipFromFrames(std::move(skeleton), frames, std::move(properties));
}

absl::StatusOr<MotionClip> CrossFade(const MotionClip& first,
                                     const MotionClip& second, double start_s,
                                     double fade_s) {
  if (!(std::isfinite(fade_s) && fade_s >= 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("fade_s: want a finite number >= 0, got ", fade_s));
  }
  if (!(std::isfinite(start_s) && start_s >= 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("start_s: want a finite number >= 0, got ", start_s));
  }
  absl::StatusOr<LayerStack> stack = LayerStack::Create(
      first.skeleton(), {{.clip = first},
                         {.clip = second,
                          .weight = WeightCurve::FadeIn(start_s, fade_s),
                          .start_s = start_s}});
  if (!stack.ok()) return stack.status();
  return ClipFromLayers(
      *std::move(stack), first.skeleton(), start_s + second.duration_s(),
      {.name = first.name(), .frame_time_s = FrameTimeOf(first)});
}

}  // namespace gelenk
