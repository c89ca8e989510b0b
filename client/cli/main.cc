// gelenk: the command line.
//
// Exit codes: 0 done, 1 the request failed, 2 the command line is wrong.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "client/cli/command.h"

namespace gelenk::cli {
namespace {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;

constexpr char kAbout[] =
    "Inverse kinematics from the command line: reads skeletons and motion "
    "capture, asks a gelenk service for poses, prints and draws what it "
    "answers.";

constexpr char kExamples[] =
    "Examples:\n"
    "  gelenk info walk.bvh\n"
    "  gelenk info robot.urdf\n"
    "  gelenk ik walk.bvh --goal LeftHand=0.4,1.2,0.3\n"
    "  gelenk play walk.bvh --out solved.bvh --picture solved.svg\n"
    "  gelenk --server localhost:50051 sessions\n"
    "`gelenk COMMAND --help` tells more.";

void PrintError(const std::string& message) {
  std::fprintf(stderr, "gelenk: %s\n", message.c_str());
}

// Help and version are printed as they are; a mistake in one line.
int EndOfParsing(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
    return app.exit(error);
  }
  PrintError(error.what() + std::string(" (see gelenk --help)"));
  return kUsage;
}

int Run(const Command& command, const GlobalOptions& options) {
  std::string output;
  const absl::Status status = command.run(options, &output);
  const bool printed =
      std::fwrite(output.data(), 1, output.size(), stdout) == output.size() &&
      std::fflush(stdout) == 0;
  if (!status.ok()) PrintError(std::string(status.message()));
  return status.ok() && printed ? kDone : kFailed;
}

}  // namespace
}  // namespace gelenk::cli

int main(int argc, char** argv) {
  using namespace gelenk::cli;  // NOLINT(google-build-using-namespace)
  CLI::App app(kAbout, "gelenk");
  GlobalOptions options;
  app.add_option("--server", options.server,
                 "Address of a running service, host:port; without it the "
                 "command hosts one for itself")
      ->option_text("ADDR");
  app.set_version_flag("--version", "gelenk " GELENK_VERSION);
  app.footer(kExamples);
  app.fallthrough();
  app.require_subcommand(1);
  const std::vector<Command> commands = {
      AddInfoCommand(app),    AddFkCommand(app),       AddIkCommand(app),
      AddPlayCommand(app),    AddReplayCommand(app),   AddSessionsCommand(app),
      AddBenchCommand(app),   AddExamplesCommand(app), AddDhCommand(app),
      AddTwoLinkCommand(app), AddTwoBoneCommand(app),  AddWorkspaceCommand(app),
      AddClipCommand(app),    AddRetargetCommand(app), AddMapCommand(app),
      AddSkinCommand(app),    AddBridgeCommand(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return EndOfParsing(app, error);
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return Run(command, options);
  }
  return kUsage;
}
