// Vertices as they are selected on the command line.
#ifndef CLIENT_CLI_SKIN_SELECTOR_ARGUMENT_H_
#define CLIENT_CLI_SKIN_SELECTOR_ARGUMENT_H_

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::cli {

// "0-99,120,130-140" as runs; in any order. INVALID_ARGUMENT naming the piece.
absl::StatusOr<v1::VertexRuns> ParseVertexRuns(absl::string_view text);

struct SelectorArguments {
  std::string ids;
  std::string sphere;
  std::string box;
  std::optional<int> component;
  std::string ray;
};

// --ids, --sphere, --box, --component, --ray: one of them.
void AddSelectorOptions(CLI::App& app, SelectorArguments* arguments);

// INVALID_ARGUMENT naming the option; without any a selector without a kind.
absl::StatusOr<v1::VertexSelector> SelectorOf(
    const SelectorArguments& arguments);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_SKIN_SELECTOR_ARGUMENT_H_
