#include "client/cli/motion/clip_blend.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/motion/motion_file.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/clip_skeleton.h"
#include "gelenk/motion/difference_clip.h"
#include "gelenk/motion/gait_phase.h"
#include "gelenk/motion/layer_stack.h"

namespace gelenk::cli {
namespace {

constexpr double kHalf = 0.5;

absl::StatusOr<MotionClip> OnSameSkeleton(
    const MotionClip& clip, const std::shared_ptr<const Skeleton>& skeleton) {
  absl::StatusOr<MotionClip> same = OnSkeleton(clip, skeleton);
  if (same.ok()) return same;
  return absl::InvalidArgumentError(absl::StrCat(
      "\"", clip.name(), "\" is of another skeleton; retarget it first: ",
      same.status().message()));
}

// What the second motion puts on the first.
absl::StatusOr<ClipLayer> LayerOf(const MotionClip& second,
                                  const BlendOptions& options) {
  const bool adds = !options.beyond_path.empty();
  ClipLayer layer{.clip = second,
                  .weight = options.part.value_or(adds ? 1 : kHalf)};
  if (!options.below.empty()) {
    const int joint = second.skeleton()->FindJoint(options.below);
    if (joint < 0) {
      return absl::InvalidArgumentError(
          absl::StrCat("--below: no joint \"", options.below, "\""));
    }
    layer.joint_weights = MaskBelow(*second.skeleton(), joint);
  }
  if (!adds) return layer;
  const absl::StatusOr<MotionFile> base = ReadMotionFile(options.beyond_path);
  if (!base.ok()) return base.status();
  const absl::StatusOr<MotionClip> same =
      OnSameSkeleton(base->clip, second.skeleton());
  if (!same.ok()) return same.status();
  absl::StatusOr<MotionClip> difference = DifferenceClip(second, *same);
  if (!difference.ok()) return difference.status();
  layer.clip = *std::move(difference);
  layer.kind = ClipLayer::Kind::kAdditive;
  return layer;
}

}  // namespace

void AddBlendOptions(CLI::App& app, BlendOptions* options) {
  app.add_option("--part", options->part,
                 "How much of B, 0 to 1; default 0.5, with --beyond 1")
      ->check(CLI::Range(0.0, 1.0))
      ->option_text("X");
  CLI::Option* below = app.add_option("--below", options->below,
                                      "Only this joint of B and all below it")
                           ->option_text("JOINT");
  CLI::Option* gait = app.add_flag(
      "--gait", options->gait,
      "Step by step: both at the same phase, so that feet do not cross");
  CLI::Option* at =
      app.add_option("--at", options->at_s,
                     "A, then B from this time on, with --fade between")
          ->option_text("S");
  app.add_option("--fade", options->fade_s,
                 "How long the way from A to B takes; default 0.5")
      ->needs(at)
      ->check(Positive())
      ->option_text("S");
  CLI::Option* beyond =
      app.add_option("--beyond", options->beyond_path,
                     "What B does beyond this motion is added to A")
          ->option_text("FILE");
  gait->excludes(at)->excludes(beyond)->excludes(below);
  at->excludes(beyond)->excludes(below);
}

absl::StatusOr<MotionClip> BlendClips(const MotionClip& first,
                                      const MotionClip& second,
                                      const BlendOptions& options) {
  const absl::StatusOr<MotionClip> other =
      OnSameSkeleton(second, first.skeleton());
  if (!other.ok()) return other.status();
  if (options.gait)
    return BlendGaits(first, *other, options.part.value_or(kHalf));
  if (options.at_s) {
    return CrossFade(first, *other, *options.at_s, options.fade_s);
  }
  absl::StatusOr<ClipLayer> layer = LayerOf(*other, options);
  if (!layer.ok()) return layer.status();
  absl::StatusOr<LayerStack> stack = LayerStack::Create(
      first.skeleton(), {{.clip = first}, *std::move(layer)});
  if (!stack.ok()) return stack.status();
  ClipProperties properties = first.properties();
  properties.frame_time_s = FrameTimeOf(first);
  properties.seam_s.reset();
  const double duration_s = stack->end_s();
  return ClipFromLayers(*std::move(stack), first.skeleton(), duration_s,
                        std::move(properties));
}

}  // namespace gelenk::cli
