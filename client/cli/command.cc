#include "client/cli/command.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_join.h"
#include "client/cli/text/number_list.h"

namespace gelenk::cli {

void AddFormatOption(CLI::App& app, Format* format) {
  AddChoice<Format>(app, "--format", format,
                    {{"json", Format::kJson}, {"table", Format::kTable}},
                    "How to print; default: table");
}

CLI::Validator Positive() {
  return CLI::Validator(
      [](std::string& text) {
        const absl::StatusOr<double> number = ParseNumber(text);
        if (number.ok() && *number > 0) return std::string();
        return absl::StrCat("want a number above 0, got \"", text, "\"");
      },
      "");
}

CLI::Validator EndsWith(std::vector<std::string> ends) {
  return CLI::Validator(
      [ends = std::move(ends)](std::string& path) {
        for (const std::string& end : ends) {
          if (absl::EndsWithIgnoreCase(path, end)) return std::string();
        }
        return absl::StrCat("want a file that ends with ",
                            absl::StrJoin(ends, " or "), ", got \"", path,
                            "\"");
      },
      "");
}

void AddSkeletonFileOptions(CLI::App& app, SkeletonFileOptions* options) {
  app.add_option("FILE", options->path,
                 "Motion capture (.bvh, .asf), a robot (.urdf), a model "
                 "(.gltf, .glb), or a skeleton (.json)")
      ->required()
      ->option_text("");
  app.add_option("--unit", options->unit_m,
                 "Metres per unit of the file; default: of BVH guessed from "
                 "the body's height, of glTF 1")
      ->check(Positive())
      ->option_text("M");
  app.add_option("--skin", options->skin,
                 "Name or index of a glTF file's skin; default: the one with "
                 "the most joints")
      ->option_text("NAME");
}

}  // namespace gelenk::cli
