// gelenk clip: motion files looked at, measured and processed.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/motion/clip_blend.h"
#include "client/cli/motion/clip_info.h"
#include "client/cli/motion/clip_options.h"
#include "client/cli/motion/clip_writer.h"
#include "client/cli/motion/motion_file.h"
#include "client/cli/motion/motion_picture.h"
#include "client/cli/motion/quality_text.h"
#include "client/cli/motion/served_clips.h"
#include "gelenk/motion/clip_cut.h"
#include "gelenk/motion/low_pass.h"
#include "gelenk/motion/mirror.h"
#include "gelenk/retarget/plant_feet.h"

namespace gelenk::cli {
namespace {

absl::Status RunInfo(const ClipOptions& options, std::string* output) {
  const absl::StatusOr<MotionFile> file =
      ReadMotionFile(options.path, options.motion);
  if (!file.ok()) return file.status();
  *output += options.format == Format::kJson ? JsonText(ClipInfoJson(*file))
                                             : ClipInfoText(*file);
  return absl::OkStatus();
}

std::string MeasuredOutput(const MeasuredMotion& measured, Format format) {
  return format == Format::kJson ? JsonText(MeasuredJson(measured))
                                 : MeasuredText(measured);
}

absl::Status RunMeasure(const ClipOptions& options, std::string* output) {
  absl::StatusOr<BodyFile> body =
      ReadMovingBodyFile(options.path, options.motion);
  if (!body.ok()) return body.status();
  std::optional<BodyFile> reference;
  if (!options.reference_path.empty()) {
    absl::StatusOr<BodyFile> read = ReadMovingBodyFile(
        options.reference_path, {.animation = options.reference_animation});
    if (!read.ok()) return read.status();
    reference = *std::move(read);
    PairFrames(*body, *reference);
  }
  const absl::StatusOr<MeasuredMotion> measured =
      MeasureBody(*body, reference ? &*reference : nullptr);
  if (!measured.ok()) return InFile(options.path, measured.status());
  *output += MeasuredOutput(*measured, options.format);
  if (options.picture_path.empty()) return absl::OkStatus();
  return WriteMotionPicture(*body, reference ? &*reference : nullptr,
                            options.picture_path);
}

absl::StatusOr<MotionClip> Planted(const MotionClip& clip,
                                   std::string* output) {
  absl::StatusOr<PlantedClip> planted = PlantFeet(clip);
  if (!planted.ok()) return planted.status();
  for (const std::string& note : planted->notes) {
    absl::StrAppend(output, note, "\n");
  }
  return std::move(planted->clip);
}

absl::StatusOr<MotionClip> Blended(const ClipOptions& options,
                                   const MotionClip& clip) {
  const absl::StatusOr<MotionFile> second = ReadMotionFile(options.second_path);
  if (!second.ok()) return second.status();
  return BlendClips(clip, second->clip, options.blending);
}

// What the steps make of a clip; convert changes nothing.
absl::StatusOr<MotionClip> Processed(const ClipOptions& options,
                                     const MotionClip& clip,
                                     std::string* output) {
  if (options.smooth->parsed()) {
    // What is no part of the motion would be smeared over it.
    const absl::StatusOr<MotionPart> motion = CutToMotion(clip);
    if (!motion.ok()) return motion.status();
    if (motion->frames_before > 0) {
      absl::StrAppend(output, LeftOutText(motion->frames_before), "\n");
    }
    return LowPassClip(motion->clip, options.cutoff_hz);
  }
  if (options.mirror->parsed()) {
    const absl::StatusOr<MirrorMap> map = FindMirrorMap(*clip.skeleton());
    if (!map.ok()) return map.status();
    return MirrorClip(clip, *map);
  }
  if (options.plant->parsed()) return Planted(clip, output);
  if (options.crop->parsed()) {
    return CropClip(clip, options.start_s,
                    options.end_s.value_or(clip.duration_s()));
  }
  if (options.resample->parsed()) {
    return ResampleClip(clip, 1 / options.rate_hz);
  }
  if (options.blend->parsed()) return Blended(options, clip);
  return clip;
}

absl::Status RunProcess(const ClipOptions& options, std::string* output) {
  const absl::StatusOr<MotionFile> file =
      ReadMotionFile(options.path, options.motion);
  if (!file.ok()) return file.status();
  const absl::StatusOr<MotionClip> processed =
      Processed(options, file->clip, output);
  if (!processed.ok()) {
    // A blend is of two files, and names the one that is wrong.
    return options.blend->parsed() ? processed.status()
                                   : InFile(options.path, processed.status());
  }
  if (absl::Status status = WriteClip(
          *processed, file->form ? &*file->form : nullptr, options.out_path);
      !status.ok()) {
    return status;
  }
  absl::StrAppend(output, "wrote ", options.out_path, "\n");
  return absl::OkStatus();
}

// The same by a service.
absl::Status RunServedMeasure(const ClipOptions& options,
                              const std::string& server, std::string* output) {
  const auto clips = ServedClips::Open(server);
  if (!clips.ok()) return clips.status();
  const auto clip = (*clips)->Upload(options.path, options.motion);
  if (!clip.ok()) return clip.status();
  absl::StatusOr<v1::Clip> reference = v1::Clip();
  if (!options.reference_path.empty()) {
    reference = (*clips)->Upload(options.reference_path,
                                 {.animation = options.reference_animation});
    if (!reference.ok()) return reference.status();
  }
  const auto measured = (*clips)->Measure(clip->name(), reference->name());
  if (!measured.ok()) return InFile(options.path, measured.status());
  *output += MeasuredOutput(*measured, options.format);
  return absl::OkStatus();
}

// What is to be done to a clip; nothing converts it.
std::vector<v1::ClipStep> StepsOf(const ClipOptions& options) {
  v1::ClipStep step;
  if (options.smooth->parsed()) {
    step.mutable_low_pass()->set_cutoff_hz(options.cutoff_hz);
  } else if (options.mirror->parsed()) {
    step.mutable_mirror();
  } else if (options.plant->parsed()) {
    step.mutable_plant_feet();
  } else if (options.crop->parsed()) {
    step.mutable_crop()->set_start_s(options.start_s);
    if (options.end_s) step.mutable_crop()->set_end_s(*options.end_s);
  } else if (options.resample->parsed()) {
    step.mutable_resample()->set_frame_time_s(1 / options.rate_hz);
  } else {
    return {};
  }
  return {step};
}

absl::Status RunServedProcess(const ClipOptions& options,
                              const std::string& server, std::string* output) {
  // Before anything is sent.
  if (const auto format = ClipFormatOf(options.out_path); !format.ok()) {
    return format.status();
  }
  const auto clips = ServedClips::Open(server);
  if (!clips.ok()) return clips.status();
  absl::StatusOr<v1::Clip> clip =
      (*clips)->Upload(options.path, options.motion);
  if (!clip.ok()) return clip.status();
  const std::vector<v1::ClipStep> steps = StepsOf(options);
  if (!steps.empty()) {
    clip = (*clips)->Process(clip->name(), steps);
    if (!clip.ok()) return InFile(options.path, clip.status());
    for (const std::string& note : clip->warnings()) {
      absl::StrAppend(output, note, "\n");
    }
  }
  absl::Status status = (*clips)->Write(clip->name(), options.out_path);
  if (status.ok()) absl::StrAppend(output, "wrote ", options.out_path, "\n");
  return status;
}

}  // namespace

Command AddClipCommand(CLI::App& app) {
  auto options = std::make_shared<ClipOptions>();
  CLI::App* clip =
      app.add_subcommand("clip", "Measure and process motion files");
  clip->require_subcommand(1);
  AddClipSteps(*clip, app.get_option("--server"), options.get());
  clip->footer(
      "Examples:\n"
      "  gelenk clip info model.glb\n"
      "  gelenk clip measure walk.bvh --picture walk.svg\n"
      "  gelenk clip smooth walk.bvh --cutoff 5 --out smooth.bvh\n"
      "  gelenk clip blend walk.bvh run.bvh --gait --part 0.3 --out jog.bvh\n"
      "  gelenk clip convert walk.bvh --out walk.glb");
  return {clip, [options](const GlobalOptions& globals, std::string* output) {
            const bool is_served = !globals.server.empty();
            if (options->info->parsed()) return RunInfo(*options, output);
            if (options->measure->parsed()) {
              return is_served
                         ? RunServedMeasure(*options, globals.server, output)
                         : RunMeasure(*options, output);
            }
            return is_served
                       ? RunServedProcess(*options, globals.server, output)
                       : RunProcess(*options, output);
          }};
}

}  // namespace gelenk::cli
