// gelenk info: what is in a file. Needs no service.
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/info/inspection.h"
#include "convert/skeleton.h"

namespace gelenk::cli {
namespace {

struct InfoOptions {
  SkeletonFileOptions file;
  Format format = Format::kTable;
  std::string save_path;
};

absl::Status RunInfo(const InfoOptions& options, std::string* output) {
  const absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(
      options.file.path, options.file.unit_m, options.file.skin);
  if (!file.ok()) return file.status();
  const Inspection inspection = Inspect(*file);
  *output += options.format == Format::kJson
                 ? JsonText(InspectionJson(inspection))
                 : InspectionText(inspection);
  if (options.save_path.empty()) return absl::OkStatus();
  return WriteFile(options.save_path, convert::SkeletonToJson(file->message));
}

}  // namespace

Command AddInfoCommand(CLI::App& app) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* info = app.add_subcommand(
      "info",
      "Print what is in a motion capture, robot, model or skeleton file");
  AddSkeletonFileOptions(*info, &options->file);
  AddFormatOption(*info, &options->format);
  info->add_option("--save", options->save_path,
                   "Also write the skeleton, without motion, as proto3 JSON")
      ->option_text("FILE.json");
  info->footer(
      "Examples:\n"
      "  gelenk info walk.bvh\n"
      "  gelenk info robot.urdf\n"
      "  gelenk info walk.bvh --unit 0.01 --save body.json");
  return {info, [options](const GlobalOptions&, std::string* output) {
            return RunInfo(*options, output);
          }};
}

}  // namespace gelenk::cli
