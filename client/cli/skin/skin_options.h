// What `gelenk skin` is told.
#ifndef CLIENT_CLI_SKIN_SKIN_OPTIONS_H_
#define CLIENT_CLI_SKIN_SKIN_OPTIONS_H_

#include <CLI/CLI.hpp>
#include <string>

#include "client/cli/skin/pose_arguments.h"
#include "client/cli/skin/selector_argument.h"
#include "client/cli/skin/skin_demo.h"
#include "client/cli/skin/skin_source.h"
#include "client/cli/text/format.h"
#include "gelenk/v1/skin_service.pb.h"

namespace gelenk::cli {

struct SkinOptions {
  // The steps: one of them is parsed.
  CLI::App* bind = nullptr;
  CLI::App* report = nullptr;
  CLI::App* rebind = nullptr;
  CLI::App* deform = nullptr;
  CLI::App* do_export = nullptr;
  CLI::App* list = nullptr;
  CLI::App* remove = nullptr;
  CLI::App* demo = nullptr;

  SkinSourceOptions source;
  std::string keep_id;
  std::string assignments_path;
  Format format = Format::kTable;
  SelectorArguments selector;
  std::string link_id;
  v1::AssignmentScope scope = v1::ASSIGNMENT_SCOPE_CHAIN;
  bool dry_run = false;
  bool undo = false;
  PoseArguments poses;
  v1::VertexEncoding encoding = v1::VERTEX_ENCODING_QUANTIZED_16_OCT_8;
  std::string picture_path;
  std::string out_path;
  SkinDemoOptions demonstration;
};

// Adds the steps with their options.
void AddSkinSteps(CLI::App& skin, SkinOptions* options);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SKIN_OPTIONS_H_
