#include "server/rpc/clip_steps.h"

#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "convert/clip_layer.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/clip_cut.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/difference_clip.h"
#include "gelenk/motion/gait_phase.h"
#include "gelenk/motion/hampel.h"
#include "gelenk/motion/low_pass.h"
#include "gelenk/motion/mirror.h"
#include "gelenk/retarget/plant_feet.h"
#include "server/rpc/clip_message.h"

namespace gelenk::server {
namespace {

using Made = absl::StatusOr<MotionClip>;

// Each is sampled in every frame.
constexpr int kMaxLayers = 64;

// A clip of the same skeleton that a request names at `field`.
Made FindOther(const ServiceState& state, absl::string_view field,
               const std::string& name,
               const std::shared_ptr<const Skeleton>& skeleton) {
  const absl::StatusOr<StoredClip> other = FindClip(state, field, name);
  if (!other.ok()) return other.status();
  if (skeleton != nullptr && other->clip.skeleton() != skeleton) {
    return absl::FailedPreconditionError(
        absl::StrCat(field, ": ", name, " is of ", other->skeleton_name,
                     ", another skeleton; retarget it first"));
  }
  return other->clip;
}

// Everything that a step may need.
struct StepContext {
  const ServiceState& state;
  // Where the step is in the request.
  absl::string_view field;
  StoredClip& stored;

  const MotionClip& clip() const { return stored.clip; }
  const Limits& limits() const { return state.options.limits; }
  std::string Path(absl::string_view name) const {
    return absl::StrCat(field, ".", name);
  }
  Made Other(absl::string_view name, const std::string& clip_name) const {
    return FindOther(state, Path(name), clip_name, stored.clip.skeleton());
  }
  absl::Status CheckFrames(absl::string_view name, double duration_s,
                           double frame_time_s) const {
    return CheckFrameCount(name, duration_s / frame_time_s + 1,
                           *stored.clip.skeleton(), limits());
  }
};

Made Apply(const StepContext& context, const v1::LowPass& step) {
  // What is no part of the motion would be smeared over it.
  const absl::StatusOr<MotionPart> motion = CutToMotion(context.clip());
  if (!motion.ok()) return motion.status();
  Made made = LowPassClip(motion->clip, step.cutoff_hz());
  if (made.ok() && motion->frames_before > 0) {
    context.stored.warnings.push_back(LeftOutText(motion->frames_before));
  }
  return made;
}

Made Apply(const StepContext& context, const v1::RejectOutliers& step) {
  HampelOptions options;
  if (step.has_reach()) options.reach = step.reach();
  if (step.has_sigmas()) options.sigmas = step.sigmas();
  absl::StatusOr<HampelResult> result = RejectOutliers(context.clip(), options);
  if (!result.ok()) return result.status();
  context.stored.warnings.push_back(
      absl::StrCat(result->replaced.size(), " samples were outliers"));
  return std::move(result->clip);
}

Made Apply(const StepContext& context, const v1::Crop& step) {
  return CropClip(
      context.clip(), step.start_s(),
      step.has_end_s() ? step.end_s() : context.clip().duration_s());
}

Made Apply(const StepContext& context, const v1::Resample& step) {
  if (absl::Status status = context.CheckFrames(
          "frame_time_s", context.clip().duration_s(), step.frame_time_s());
      !status.ok()) {
    return status;
  }
  return ResampleClip(context.clip(), step.frame_time_s());
}

absl::StatusOr<std::vector<WarpKey>> KeysAlong(const StepContext& context,
                                               const v1::TimeWarp& step) {
  if (step.has_curve()) {
    std::vector<WarpKey> keys;
    for (const v1::WarpKey& key : step.curve().keys()) {
      keys.push_back({key.time_s(), key.clip_time_s()});
    }
    return keys;
  }
  const Made other = context.Other("strikes_of_clip", step.strikes_of_clip());
  if (!other.ok()) return other.status();
  const absl::StatusOr<GaitPhase> reference = FindGaitPhase(*other);
  if (!reference.ok()) return reference.status();
  const absl::StatusOr<GaitPhase> phase = FindGaitPhase(context.clip());
  if (!phase.ok()) return phase.status();
  std::vector<WarpKey> keys = AlignStrikes(*reference, *phase);
  if (keys.size() < 2) {
    return absl::FailedPreconditionError(absl::StrCat(
        context.Path("strikes_of_clip"), ": fewer than two strikes in common"));
  }
  return keys;
}

Made Apply(const StepContext& context, const v1::TimeWarp& step) {
  if (step.by_case() == v1::TimeWarp::BY_NOT_SET) {
    return absl::InvalidArgumentError("want a curve or a clip, got neither");
  }
  const absl::StatusOr<std::vector<WarpKey>> keys = KeysAlong(context, step);
  if (!keys.ok()) return keys.status();
  if (!keys->empty()) {
    if (absl::Status status = context.CheckFrames("curve", keys->back().time_s,
                                                  FrameTimeOf(context.clip()));
        !status.ok()) {
      return status;
    }
  }
  return WarpClip(context.clip(), *keys);
}

Made Apply(const StepContext& context, const v1::MirrorMotion&) {
  const absl::StatusOr<MirrorMap> map =
      FindMirrorMap(*context.clip().skeleton());
  if (!map.ok()) return map.status();
  if (!map->by_names) {
    context.stored.warnings.emplace_back(
        "left and right are told by shape, names do not say");
  }
  return MirrorClip(context.clip(), *map);
}

Made Apply(const StepContext& context, const v1::LayClips& step) {
  const MotionClip& base = context.clip();
  absl::StatusOr<std::vector<ClipLayer>> layers = LayersFromProto(
      context.state, context.Path("layers"), base.skeleton(), step.layers());
  if (!layers.ok()) return layers.status();
  ClipLayer bottom{.clip = base};
  if (step.has_base_weight()) {
    bottom.weight = convert::FromProto(step.base_weight());
  }
  if (step.loop_base()) bottom.mode = PlaybackMode::kLoop;
  layers->insert(layers->begin(), std::move(bottom));
  absl::StatusOr<LayerStack> stack =
      LayerStack::Create(base.skeleton(), *std::move(layers));
  if (!stack.ok()) return stack.status();
  const double duration_s =
      step.duration_s() == 0 ? stack->end_s() : step.duration_s();
  ClipProperties properties = base.properties();
  properties.frame_time_s = FrameTimeOf(base);
  properties.seam_s.reset();
  if (absl::Status status = context.CheckFrames("duration_s", duration_s,
                                                properties.frame_time_s);
      !status.ok()) {
    return status;
  }
  return ClipFromLayers(*std::move(stack), base.skeleton(), duration_s,
                        std::move(properties));
}

Made Apply(const StepContext& context, const v1::BlendGait& step) {
  const Made other = context.Other("clip", step.clip());
  if (!other.ok()) return other.status();
  return BlendGaits(context.clip(), *other, step.part());
}

Made Apply(const StepContext& context, const v1::Difference& step) {
  switch (step.base_case()) {
    case v1::Difference::kClip: {
      const Made base = context.Other("clip", step.clip());
      if (!base.ok()) return base.status();
      return DifferenceClip(context.clip(), *base);
    }
    case v1::Difference::kPose: {
      const absl::StatusOr<Eigen::VectorXd> pose =
          convert::FromProto(*context.clip().skeleton(), step.pose());
      if (!pose.ok()) return pose.status();
      return DifferenceClip(context.clip(), *pose);
    }
    case v1::Difference::BASE_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("want a clip or a pose, got neither");
}

Made Apply(const StepContext& context, const v1::PlantFeet&) {
  absl::StatusOr<PlantedClip> planted = PlantFeet(context.clip());
  if (!planted.ok()) return planted.status();
  for (std::string& note : planted->notes) {
    context.stored.warnings.push_back(std::move(note));
  }
  return std::move(planted->clip);
}

absl::string_view NameOf(const v1::ClipStep& step) {
  const auto* oneof = v1::ClipStep::descriptor()->FindOneofByName("step");
  const auto* field =
      step.GetReflection()->GetOneofFieldDescriptor(step, oneof);
  return field == nullptr ? absl::string_view() : field->name();
}

Made ApplyAny(const StepContext& context, const v1::ClipStep& step) {
  switch (step.step_case()) {
    case v1::ClipStep::kLowPass:
      return Apply(context, step.low_pass());
    case v1::ClipStep::kRejectOutliers:
      return Apply(context, step.reject_outliers());
    case v1::ClipStep::kCrop:
      return Apply(context, step.crop());
    case v1::ClipStep::kResample:
      return Apply(context, step.resample());
    case v1::ClipStep::kTimeWarp:
      return Apply(context, step.time_warp());
    case v1::ClipStep::kMirror:
      return Apply(context, step.mirror());
    case v1::ClipStep::kLayers:
      return Apply(context, step.layers());
    case v1::ClipStep::kBlendGait:
      return Apply(context, step.blend_gait());
    case v1::ClipStep::kDifference:
      return Apply(context, step.difference());
    case v1::ClipStep::kPlantFeet:
      return Apply(context, step.plant_feet());
    case v1::ClipStep::STEP_NOT_SET:
      break;
  }
  return absl::InvalidArgumentError("want a step, got none");
}

}  // namespace

absl::StatusOr<std::vector<ClipLayer>> LayersFromProto(
    const ServiceState& state, absl::string_view field,
    std::shared_ptr<const Skeleton> skeleton,
    const google::protobuf::RepeatedPtrField<v1::ClipLayer>& protos) {
  std::vector<ClipLayer> layers;
  Violations violations;
  if (protos.empty() || protos.size() > kMaxLayers) {
    violations.Add(
        field, absl::StrCat("want 1 to ", kMaxLayers, ", got ", protos.size()));
    return violations.ToStatus();
  }
  for (int i = 0; i < protos.size(); ++i) {
    const std::string path = absl::StrCat(field, "[", i, "]");
    Made clip = FindOther(state, absl::StrCat(path, ".clip"), protos[i].clip(),
                          skeleton);
    if (!clip.ok()) return clip.status();
    skeleton = clip->skeleton();
    absl::StatusOr<ClipLayer> layer =
        convert::FromProto(protos[i], *std::move(clip));
    violations.AddStatus(path, layer.status());
    if (layer.ok()) layers.push_back(*std::move(layer));
  }
  if (!violations.empty()) return violations.ToStatus();
  return layers;
}

absl::Status ApplyStep(const ServiceState& state, absl::string_view field,
                       const v1::ClipStep& step, StoredClip& stored) {
  const std::string path = absl::StrCat(
      field, NameOf(step).empty() ? "" : absl::StrCat(".", NameOf(step)));
  // Nearly all steps sample the clip.
  if (absl::Status status =
          CheckFrameCount(path, stored.clip, state.options.limits);
      !status.ok()) {
    return status;
  }
  Made made = ApplyAny({state, path, stored}, step);
  if (made.ok()) {
    stored.clip = *std::move(made);
    return absl::OkStatus();
  }
  // A name that was looked up is told with its path already.
  if (!absl::IsInvalidArgument(made.status()) ||
      absl::StartsWith(made.status().message(), path)) {
    return made.status();
  }
  Violations violations;
  violations.AddStatus(path, made.status());
  return violations.ToStatus();
}

}  // namespace gelenk::server
