// gelenk clip: motion files measured and processed.
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/motion/clip_writer.h"
#include "client/cli/motion/motion_picture.h"
#include "client/cli/motion/quality_text.h"
#include "gelenk/formats/bvh_clip.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/first_frame.h"
#include "gelenk/motion/low_pass.h"
#include "gelenk/motion/mirror.h"

namespace gelenk::cli {
namespace {

struct ClipOptions {
  CLI::App* measure = nullptr;
  CLI::App* smooth = nullptr;
  CLI::App* mirror = nullptr;
  CLI::App* convert = nullptr;
  std::string path;
  std::optional<double> unit_m;
  std::string reference_path;
  std::string out_path;
  std::string picture_path;
  double cutoff_hz = 6;
  Format format = Format::kTable;
};

absl::Status RunMeasure(const ClipOptions& options, std::string* output) {
  const absl::StatusOr<BodyFile> body =
      ReadBodyFile(options.path, options.unit_m);
  if (!body.ok()) return body.status();
  std::optional<BodyFile> reference;
  if (!options.reference_path.empty()) {
    absl::StatusOr<BodyFile> read =
        ReadBodyFile(options.reference_path, std::nullopt);
    if (!read.ok()) return read.status();
    reference = *std::move(read);
  }
  const absl::StatusOr<Measured> measured =
      Measure(*body, reference ? &*reference : nullptr);
  if (!measured.ok()) return measured.status();
  *output += options.format == Format::kJson ? JsonText(MeasuredJson(*measured))
                                             : MeasuredText(*measured);
  if (options.picture_path.empty()) return absl::OkStatus();
  return WriteMotionPicture(*body, reference ? &*reference : nullptr,
                            options.picture_path);
}

std::string FramesLeftOutText(int count) {
  if (count == 1) return "frame 0 is no part of the motion and left out";
  return absl::StrCat("frames 0 to ", count - 1,
                      " are no part of the motion and left out");
}

// What smooth, mirror and convert make of a clip.
absl::StatusOr<MotionClip> Processed(const ClipOptions& options,
                                     const MotionClip& clip) {
  if (options.smooth->parsed()) return LowPassClip(clip, options.cutoff_hz);
  if (options.mirror->parsed()) {
    const absl::StatusOr<MirrorMap> map = FindMirrorMap(*clip.skeleton());
    if (!map.ok()) return map.status();
    return MirrorClip(clip, *map);
  }
  return clip;
}

absl::Status RunProcess(const ClipOptions& options, std::string* output) {
  if (!absl::EndsWithIgnoreCase(options.path, ".bvh")) {
    return InFile(options.path, absl::InvalidArgumentError("want a .bvh file"));
  }
  const absl::StatusOr<BvhClip> file =
      ReadBvhClip(options.path, options.unit_m);
  if (!file.ok()) return file.status();
  const absl::StatusOr<MotionClip> clip =
      ClipFromBvh(file->document, file->import, BaseName(options.path));
  if (!clip.ok()) return InFile(options.path, clip.status());
  absl::StatusOr<MotionClip> motion = clip;
  if (options.smooth->parsed()) {
    // What is no part of the motion would be smeared over it.
    const int before =
        CountFramesBeforeMotion(*file->import.skeleton, file->poses);
    if (before > 0) {
      absl::StrAppend(output, FramesLeftOutText(before), "\n");
      motion = ClipFromFrames(
          clip->skeleton(), file->poses.rightCols(file->frame_count() - before),
          clip->properties());
      if (!motion.ok()) return InFile(options.path, motion.status());
    }
  }
  const absl::StatusOr<MotionClip> processed = Processed(options, *motion);
  if (!processed.ok()) return InFile(options.path, processed.status());
  if (absl::Status status = WriteClip(*processed, &*file, options.out_path);
      !status.ok()) {
    return status;
  }
  absl::StrAppend(output, "wrote ", options.out_path, "\n");
  return absl::OkStatus();
}

CLI::App* AddStep(CLI::App& clip, const std::string& name,
                  const std::string& description, ClipOptions* options) {
  CLI::App* step = clip.add_subcommand(name, description);
  step->add_option("FILE", options->path, "Motion capture (.bvh)")
      ->required()
      ->option_text("");
  step->add_option("--unit", options->unit_m,
                   "Metres per unit of the file; default: guessed")
      ->check(Positive())
      ->option_text("M");
  return step;
}

void AddOut(CLI::App& step, ClipOptions* options) {
  step.add_option("--out", options->out_path, "A .bvh, .gltf or .glb file")
      ->required()
      ->option_text("FILE");
}

}  // namespace

Command AddClipCommand(CLI::App& app) {
  auto options = std::make_shared<ClipOptions>();
  CLI::App* clip =
      app.add_subcommand("clip", "Measure and process motion files");
  clip->require_subcommand(1);
  options->measure = AddStep(*clip, "measure",
                             "Skate, penetration, hyper-extension, jerk, "
                             "jumps; see docs/motion-quality.md",
                             options.get());
  options->measure
      ->add_option("--reference", options->reference_path,
                   "The motion that FILE was made from: its contacts count, "
                   "and ratios are printed")
      ->option_text("SOURCE.bvh");
  options->measure
      ->add_option("--picture", options->picture_path,
                   "The motion as figures over time, with its contacts")
      ->option_text("SVG");
  AddFormatOption(*options->measure, &options->format);
  options->smooth = AddStep(*clip, "smooth",
                            "Without tremor, and without delay", options.get());
  options->smooth
      ->add_option("--cutoff", options->cutoff_hz,
                   "Where half of a movement's power is left, Hz; default 6")
      ->check(Positive())
      ->option_text("HZ");
  AddOut(*options->smooth, options.get());
  options->mirror =
      AddStep(*clip, "mirror", "Left becomes right", options.get());
  AddOut(*options->mirror, options.get());
  options->convert =
      AddStep(*clip, "convert", "The same motion as glTF", options.get());
  AddOut(*options->convert, options.get());
  clip->footer(
      "Examples:\n"
      "  gelenk clip measure walk.bvh --picture walk.svg\n"
      "  gelenk clip smooth walk.bvh --cutoff 5 --out smooth.bvh\n"
      "  gelenk clip convert walk.bvh --out walk.glb");
  return {clip, [options](const GlobalOptions&, std::string* output) {
            return options->measure->parsed() ? RunMeasure(*options, output)
                                              : RunProcess(*options, output);
          }};
}

}  // namespace gelenk::cli
