#include "server/ops/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "absl/strings/ascii.h"
#include "server/version.h"

namespace gelenk::server {
namespace {

// A duration flag: "20s", "1m30s", "500ms".
void AddDuration(CLI::App& app, const std::string& name, absl::Duration& value,
                 const std::string& help) {
  app.add_option_function<std::string>(
         name,
         [&value, name](const std::string& text) {
           if (!absl::ParseDuration(text, &value)) {
             throw CLI::ValidationError(
                 name, "want a duration such as 20s, got \"" + text + "\"");
           }
         },
         help + " [" + absl::FormatDuration(value) + "]")
      ->type_name("DURATION");
}

template <typename T>
void AddNumber(CLI::App& app, const std::string& name, T& value,
               const std::string& help) {
  app.add_option(name, value, help)->capture_default_str();
}

void AddLimits(CLI::App& app, Limits& limits) {
  AddNumber(app, "--max-sessions", limits.max_sessions, "Sessions at a time");
  AddNumber(app, "--max-skeletons", limits.max_skeletons,
            "Skeletons at a time");
  AddNumber(app, "--max-skeleton-bytes", limits.max_skeleton_bytes,
            "All skeletons together, bytes");
  AddNumber(app, "--max-joints", limits.max_joints, "Joints of one skeleton");
  AddNumber(app, "--max-clips", limits.max_clips, "Clips at a time");
  AddNumber(app, "--max-clip-bytes", limits.max_clip_bytes,
            "All clips together, bytes");
  AddNumber(app, "--max-clip-numbers", limits.max_clip_numbers,
            "One clip: frames times the numbers of a pose");
  AddNumber(app, "--max-clip-revisions", limits.max_clip_revisions,
            "Revisions of a clip that are kept");
  AddNumber(app, "--max-recording-bytes", limits.max_recording_bytes,
            "All recordings under way, bytes");
  AddNumber(app, "--max-skins", limits.max_skins, "Skins at a time");
  AddNumber(app, "--max-skin-bytes", limits.max_skin_bytes,
            "All skins together, bytes");
  AddNumber(app, "--max-skin-vertices", limits.max_skin_vertices,
            "Vertices of one skin");
  AddNumber(app, "--max-skin-triangles", limits.max_skin_triangles,
            "Triangles of one skin");
  AddNumber(app, "--max-skin-revisions", limits.max_skin_revisions,
            "Revisions of one skin that are kept");
  AddNumber(app, "--max-message-bytes", limits.max_message_bytes,
            "One message, bytes");
  AddNumber(app, "--max-import-bytes", limits.max_import_bytes,
            "One imported file, bytes");
  AddNumber(app, "--max-imports", limits.max_imports, "Imports at a time");
  AddDuration(app, "--import-stall", limits.import_stall,
              "How long an import may wait for its next piece");
  AddNumber(app, "--max-streams", limits.max_streams, "Streams at a time");
  AddNumber(app, "--max-slots", limits.max_slots, "Sessions on one stream");
  AddNumber(app, "--max-unsent-answers", limits.max_unsent_answers,
            "Answers that wait for a slow reader before reading stops");
  AddDuration(app, "--write-stall", limits.write_stall,
              "How long no answer may leave before a stream is ended");
  AddDuration(app, "--max-idle-ttl", limits.max_idle_ttl,
              "Longest life of an idle session");
  AddDuration(app, "--default-idle-ttl", limits.default_idle_ttl,
              "Life of an idle session that asks for none");
}

// --max-sessions becomes GELENKD_MAX_SESSIONS.
void NameEnvironment(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_configurable()) continue;
    std::string name = "GELENKD_" + option->get_lnames().front();
    for (char& c : name) c = c == '-' ? '_' : absl::ascii_toupper(c);
    option->envname(name);
  }
}

}  // namespace

std::optional<int> ParseCommandLine(int argc, char** argv,
                                    CommandLine& command_line) {
  CLI::App app("gelenkd: inverse kinematics as a service", "gelenkd");
  app.set_version_flag("--version", Version() + "\n" + BuildId());
  app.add_flag("--health-check", command_line.health_check,
               "Ask the server at --listen how it is, and exit with 0 if it "
               "serves, else with 1")
      ->configurable(false);
  ServerOptions& server = command_line.server;
  app.add_option("--listen", server.listen,
                 "Address and port; port 0 picks a free one")
      ->capture_default_str();
  app.add_flag("--insecure", server.insecure,
               "Serve plain text to other machines");
  app.add_option("--port-file", command_line.port_file,
                 "Write the port here once listening");
  AddNumber(app, "--io-threads", server.io_threads,
            "Threads that serve streams; 0 means half the cores");
  AddNumber(app, "--worker-threads", server.worker_threads,
            "Threads for unary calls and cold solves; 0 means one a core");
  app.add_option_function<std::string>(
         "--isa",
         [&server](const std::string& name) {
           const auto level = InstructionSetFromName(name);
           if (!level) {
             throw CLI::ValidationError(
                 "--isa", "want baseline, avx2 or avx512, got " + name);
           }
           server.instruction_set = *level;
         },
         "Instruction set that solves: baseline, avx2, avx512 [the best]")
      ->type_name("LEVEL");
  app.add_flag("--reflection", server.reflection,
               "Serve reflection, for buf curl and grpcurl");
  AddDuration(app, "--heartbeat", server.heartbeat,
              "Silence after which a stream hears that the server lives");
  AddDuration(app, "--keepalive", server.keepalive,
              "Silence after which a client is asked whether it lives");
  AddDuration(app, "--drain", command_line.drain,
              "How long streams have to leave after SIGTERM");
  app.add_option("--log-level", command_line.log_level,
                 "trace, debug, info, warn, error, off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
  AddLimits(app, server.limits);
  NameEnvironment(app);
  app.footer(
      "Every option is also read from the environment, --max-sessions from "
      "GELENKD_MAX_SESSIONS; the command line is stronger.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  return std::nullopt;
}

bool WritePortFile(const std::string& path, const std::string& address) {
  const std::string draft = path + ".draft";
  {
    std::ofstream file(draft);
    file << address.substr(address.rfind(':') + 1) << "\n";
    if (!file.flush()) return false;
  }
  return std::rename(draft.c_str(), path.c_str()) == 0;
}

}  // namespace gelenk::server
