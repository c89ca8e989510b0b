// gelenk clip: motion files looked at, measured and processed.
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/motion/clip_blend.h"
#include "client/cli/motion/clip_info.h"
#include "client/cli/motion/clip_writer.h"
#include "client/cli/motion/motion_file.h"
#include "client/cli/motion/motion_picture.h"
#include "client/cli/motion/quality_text.h"
#include "gelenk/motion/clip_cut.h"
#include "gelenk/motion/low_pass.h"
#include "gelenk/motion/mirror.h"
#include "gelenk/retarget/plant_feet.h"

namespace gelenk::cli {
namespace {

struct ClipOptions {
  CLI::App* info = nullptr;
  CLI::App* measure = nullptr;
  CLI::App* smooth = nullptr;
  CLI::App* mirror = nullptr;
  CLI::App* plant = nullptr;
  CLI::App* crop = nullptr;
  CLI::App* resample = nullptr;
  CLI::App* blend = nullptr;
  std::string path;
  MotionFileOptions motion;
  std::string reference_path;
  std::string reference_animation;
  std::string out_path;
  std::string picture_path;
  double cutoff_hz = 6;
  double start_s = 0;
  std::optional<double> end_s;
  double rate_hz = 0;
  std::string second_path;
  BlendOptions blending;
  Format format = Format::kTable;
};

absl::Status RunInfo(const ClipOptions& options, std::string* output) {
  const absl::StatusOr<MotionFile> file =
      ReadMotionFile(options.path, options.motion);
  if (!file.ok()) return file.status();
  *output += options.format == Format::kJson ? JsonText(ClipInfoJson(*file))
                                             : ClipInfoText(*file);
  return absl::OkStatus();
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
  *output += options.format == Format::kJson ? JsonText(MeasuredJson(*measured))
                                             : MeasuredText(*measured);
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
  if (!processed.ok()) return InFile(options.path, processed.status());
  if (absl::Status status = WriteClip(
          *processed, file->form ? &*file->form : nullptr, options.out_path);
      !status.ok()) {
    return status;
  }
  absl::StrAppend(output, "wrote ", options.out_path, "\n");
  return absl::OkStatus();
}

CLI::App* AddStep(CLI::App& clip, const std::string& name,
                  const std::string& description, ClipOptions* options) {
  CLI::App* step = clip.add_subcommand(name, description);
  step->add_option(name == "blend" ? "A" : "FILE", options->path,
                   "Motion capture (.bvh), or a model with an animation "
                   "(.gltf, .glb)")
      ->required()
      ->option_text("");
  if (name == "blend") {
    step->add_option("B", options->second_path, "Motion of the same skeleton")
        ->required()
        ->option_text("");
  }
  step->add_option("--unit", options->motion.unit_m,
                   "Metres per unit of the file; default: guessed of BVH, 1 of "
                   "glTF")
      ->check(Positive())
      ->option_text("M");
  AddAnimationOption(*step, "--animation", &options->motion.animation);
  return step;
}

// A step that writes what it makes.
CLI::App* AddMaking(CLI::App& clip, const std::string& name,
                    const std::string& description, ClipOptions* options) {
  CLI::App* step = AddStep(clip, name, description, options);
  step->add_option("--out", options->out_path, "A .bvh, .gltf or .glb file")
      ->required()
      ->option_text("FILE");
  return step;
}

}  // namespace

Command AddClipCommand(CLI::App& app) {
  auto options = std::make_shared<ClipOptions>();
  CLI::App* clip =
      app.add_subcommand("clip", "Measure and process motion files");
  clip->require_subcommand(1);
  options->info = AddStep(*clip, "info", "What is in a file", options.get());
  AddFormatOption(*options->info, &options->format);
  options->measure = AddStep(*clip, "measure",
                             "Skate, penetration, hyper-extension, jerk, "
                             "jumps; see docs/motion-quality.md",
                             options.get());
  options->measure
      ->add_option("--reference", options->reference_path,
                   "The motion that FILE was made from: its contacts count, "
                   "and ratios are printed")
      ->option_text("SOURCE");
  AddAnimationOption(*options->measure, "--reference-animation",
                     &options->reference_animation);
  options->measure
      ->add_option("--picture", options->picture_path,
                   "The motion as figures over time, with its contacts")
      ->option_text("SVG");
  AddFormatOption(*options->measure, &options->format);
  options->smooth = AddMaking(
      *clip, "smooth", "Without tremor, and without delay", options.get());
  options->smooth
      ->add_option("--cutoff", options->cutoff_hz,
                   "Where half of a movement's power is left, Hz; default 6")
      ->check(Positive())
      ->option_text("HZ");
  options->mirror =
      AddMaking(*clip, "mirror", "Left becomes right", options.get());
  options->plant = AddMaking(
      *clip, "plant", "Feet that stand neither slide nor sink", options.get());
  options->crop = AddMaking(*clip, "crop", "A part of it", options.get());
  options->crop
      ->add_option("--start", options->start_s, "From here on; default 0")
      ->option_text("S");
  options->crop->add_option("--end", options->end_s, "Up to here; default all")
      ->option_text("S");
  options->resample =
      AddMaking(*clip, "resample", "Another frame rate", options.get());
  options->resample->add_option("--rate", options->rate_hz, "Frames a second")
      ->required()
      ->check(Positive())
      ->option_text("HZ");
  options->blend =
      AddMaking(*clip, "blend", "Two motions of one skeleton", options.get());
  AddBlendOptions(*options->blend, &options->blending);
  AddMaking(*clip, "convert", "The same motion in another format",
            options.get());
  clip->footer(
      "Examples:\n"
      "  gelenk clip info model.glb\n"
      "  gelenk clip measure walk.bvh --picture walk.svg\n"
      "  gelenk clip smooth walk.bvh --cutoff 5 --out smooth.bvh\n"
      "  gelenk clip blend walk.bvh run.bvh --gait --part 0.3 --out jog.bvh\n"
      "  gelenk clip convert walk.bvh --out walk.glb");
  return {clip, [options](const GlobalOptions&, std::string* output) {
            if (options->info->parsed()) return RunInfo(*options, output);
            if (options->measure->parsed()) return RunMeasure(*options, output);
            return RunProcess(*options, output);
          }};
}

}  // namespace gelenk::cli
