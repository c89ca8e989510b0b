#include "client/cli/motion/clip_options.h"

#include "client/cli/command.h"

namespace gelenk::cli {
namespace {

CLI::App* AddStep(CLI::App& clip, const std::string& name,
                  const std::string& description, ClipOptions* options) {
  CLI::App* step = clip.add_subcommand(name, description);
  step->add_option(name == "blend" ? "A" : "FILE", options->path,
                   "Motion capture (.bvh, .amc), or a model with an animation "
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
  AddSkeletonOption(*step, &options->motion.skeleton_path);
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

void AddClipSteps(CLI::App& clip, CLI::Option* server, ClipOptions* options) {
  options->info = AddStep(clip, "info", "What is in a file", options);
  AddFormatOption(*options->info, &options->format);
  options->measure = AddStep(clip, "measure",
                             "Skate, penetration, hyper-extension, jerk, "
                             "jumps; see docs/motion-quality.md",
                             options);
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
      ->excludes(server)
      ->check(EndsWith({".svg"}))
      ->option_text("SVG");
  AddFormatOption(*options->measure, &options->format);
  options->smooth =
      AddMaking(clip, "smooth", "Without tremor, and without delay", options);
  options->smooth
      ->add_option("--cutoff", options->cutoff_hz,
                   "Where half of a movement's power is left, Hz; default 6")
      ->check(Positive())
      ->option_text("HZ");
  options->mirror = AddMaking(clip, "mirror", "Left becomes right", options);
  options->plant = AddMaking(clip, "plant",
                             "Feet that stand neither slide nor sink", options);
  options->crop = AddMaking(clip, "crop", "A part of it", options);
  options->crop
      ->add_option("--start", options->start_s, "From here on; default 0")
      ->option_text("S");
  options->crop->add_option("--end", options->end_s, "Up to here; default all")
      ->option_text("S");
  options->resample =
      AddMaking(clip, "resample", "Another frame rate", options);
  options->resample->add_option("--rate", options->rate_hz, "Frames a second")
      ->required()
      ->check(Positive())
      ->option_text("HZ");
  options->blend =
      AddMaking(clip, "blend", "Two motions of one skeleton", options);
  AddBlendOptions(*options->blend, &options->blending);
  AddMaking(clip, "convert", "The same motion in another format", options);
  options->info->excludes(server);
  options->blend->excludes(server);
}

}  // namespace gelenk::cli
