// What `gelenk clip` is told.
#ifndef CLIENT_CLI_MOTION_CLIP_OPTIONS_H_
#define CLIENT_CLI_MOTION_CLIP_OPTIONS_H_

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "client/cli/motion/clip_blend.h"
#include "client/cli/motion/motion_file.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {

struct ClipOptions {
  // The steps: one of them is parsed.
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

// Adds the steps with their options; those that work on files alone refuse
// `server`.
void AddClipSteps(CLI::App& clip, CLI::Option* server, ClipOptions* options);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_CLIP_OPTIONS_H_
