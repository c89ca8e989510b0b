// What the commands of `gelenk` have in common.
#ifndef CLIENT_CLI_COMMAND_H_
#define CLIENT_CLI_COMMAND_H_

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {

// Options that stand before or behind any command.
struct GlobalOptions {
  // Empty: the CLI hosts the service itself.
  std::string server;
};

struct Command {
  CLI::App* app = nullptr;
  // Appends what goes to standard output to `output`, which counts also when
  // the command fails.
  std::function<absl::Status(const GlobalOptions&, std::string* output)> run;
};

// Each adds its options to `app`; `run` is for when it was parsed.
Command AddBenchCommand(CLI::App& app);
Command AddBridgeCommand(CLI::App& app);
Command AddClipCommand(CLI::App& app);
Command AddDhCommand(CLI::App& app);
Command AddExamplesCommand(CLI::App& app);
Command AddInfoCommand(CLI::App& app);
Command AddFkCommand(CLI::App& app);
Command AddIkCommand(CLI::App& app);
Command AddMapCommand(CLI::App& app);
Command AddPlayCommand(CLI::App& app);
Command AddReplayCommand(CLI::App& app);
Command AddRetargetCommand(CLI::App& app);
Command AddSessionsCommand(CLI::App& app);
Command AddSkinCommand(CLI::App& app);
Command AddTwoBoneCommand(CLI::App& app);
Command AddTwoLinkCommand(CLI::App& app);
Command AddWorkspaceCommand(CLI::App& app);

// --format table|json
void AddFormatOption(CLI::App& app, Format* format);

// FILE, --unit for BVH and glTF, --skin for glTF.
struct SkeletonFileOptions {
  std::string path;
  std::optional<double> unit_m;
  std::optional<std::string> skin;
};
void AddSkeletonFileOptions(CLI::App& app, SkeletonFileOptions* options);

// One of `values`, by name.
template <class Value>
void AddChoice(CLI::App& app, const std::string& name, Value* value,
               const std::map<std::string, Value>& values,
               const std::string& description) {
  std::string names;
  for (const auto& [text, unused] : values) {
    absl::StrAppend(&names, names.empty() ? "" : "|", text);
  }
  app.add_option_function<std::string>(
         name,
         [value, values](const std::string& text) { *value = values.at(text); },
         description)
      ->check(CLI::Validator(
          [values, names](std::string& text) {
            if (values.count(text) > 0) return std::string();
            return absl::StrCat("want ", names, ", got \"", text, "\"");
          },
          ""))
      ->option_text(names);
}

// A number above 0.
CLI::Validator Positive();

// Accepts paths with one of those ends, which say what is written.
CLI::Validator EndsWith(std::vector<std::string> ends);

// Accepts what `parse` accepts; its error is the message to the user.
template <class Parse>
CLI::Validator Parses(Parse parse) {
  return CLI::Validator(
      [parse](std::string& text) {
        const absl::Status status = parse(text).status();
        return status.ok() ? std::string() : std::string(status.message());
      },
      "");
}

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_COMMAND_H_
