// gelenk replay: a logged session solved again.
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/progress_bar.h"
#include "client/cli/replay/replayer.h"
#include "client/cli/replay/session_log.h"
#include "client/cli/service.h"
#include "client/cli/skeleton_file.h"
#include "convert/skeleton.h"

namespace gelenk::cli {
namespace {

struct ReplayOptions {
  std::string path;
  Format format = Format::kTable;
};

// Which number of a pose is another.
struct Difference {
  int index = 0;
  double logged = 0;
  double solved = 0;
};

// The first number whose bits differ, or where one pose ends.
Difference FindDifference(const Eigen::VectorXd& logged,
                          const Eigen::VectorXd& solved) {
  Difference found;
  const Eigen::Index size = std::min(logged.size(), solved.size());
  while (found.index < size && HasSameBits(logged.segment(found.index, 1),
                                           solved.segment(found.index, 1))) {
    ++found.index;
  }
  if (found.index < size) {
    found.logged = logged[found.index];
    found.solved = solved[found.index];
  }
  return found;
}

// "joint "knee", number 0", of the skeleton that was solved on.
std::string NumberText(const SessionLog& log, int index) {
  const auto skeleton = convert::FromProto(log.spec.skeleton.skeleton());
  std::string text = absl::StrCat("number ", index);
  if (!skeleton.ok()) return text;
  for (int joint = 0; joint < (*skeleton)->joint_count(); ++joint) {
    const int offset = (*skeleton)->span(joint).position_offset;
    if (offset < 0 || offset > index) continue;
    text = absl::StrCat("joint \"", (*skeleton)->joint(joint).id, "\", number ",
                        index - offset);
  }
  return text;
}

std::string LevelText(const v1::ServerInfo& server) {
  return absl::StrCat(server.instruction_set(), ", build ", server.build());
}

Json ServerJson(const v1::ServerInfo& server) {
  return {{"instruction_set", server.instruction_set()},
          {"build", server.build()},
          {"version", server.version()}};
}

absl::Status DifferenceStatus(const SessionLog& log,
                              const ReplayResult& result) {
  const auto& frame = log.frames.frames()[result.first_difference];
  const Difference difference =
      FindDifference(frame.positions, result.positions);
  std::string text = absl::StrFormat(
      "frame %d (sequence_number %d) differs: %s: %.17g in the log, %.17g now",
      result.first_difference, frame.sequence_number,
      NumberText(log, difference.index), difference.logged, difference.solved);
  if (frame.positions.size() != result.positions.size()) {
    text = absl::StrFormat(
        "frame %d (sequence_number %d) differs: %d numbers in the log, %d now",
        result.first_difference, frame.sequence_number, frame.positions.size(),
        result.positions.size());
  }
  return absl::DataLossError(text);
}

Json ResultJson(const SessionLog& log, const ReplayResult& result) {
  Json json = {{"frames", log.frames.frames().size()},
               {"same", result.first_difference < 0},
               {"first_difference", nullptr},
               {"same_level", IsOfOneLevel(log.server, result.server)},
               {"recorded", ServerJson(log.server)},
               {"replayed", ServerJson(result.server)}};
  if (result.first_difference >= 0) {
    json["first_difference"] = result.first_difference;
  }
  return json;
}

std::string ResultText(const SessionLog& log, const ReplayResult& result) {
  std::string text;
  if (!IsOfOneLevel(log.server, result.server)) {
    absl::StrAppend(&text, "recorded on ", LevelText(log.server),
                    ", solved again on ", LevelText(result.server),
                    ": the same bits are promised on one level and build "
                    "only\n");
  }
  if (result.first_difference < 0) {
    absl::StrAppend(&text, log.frames.frames().size(),
                    " frames: joint angles are the same bit by bit (",
                    result.server.instruction_set(), ")\n");
  }
  return text;
}

absl::Status RunReplay(const ReplayOptions& options,
                       const GlobalOptions& globals, std::string* output) {
  const absl::StatusOr<SessionLog> log = ReadSessionLog(options.path);
  if (!log.ok()) return log.status();
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  ProgressBar progress(BaseName(options.path),
                       static_cast<int>(log->frames.frames().size()));
  const absl::StatusOr<ReplayResult> result =
      ReplaySession((*service)->connection(), *log,
                    [&progress](int done) { progress.Update(done); });
  if (!result.ok()) return InFile(options.path, result.status());
  *output += options.format == Format::kJson
                 ? JsonText(ResultJson(*log, *result))
                 : ResultText(*log, *result);
  if (result->first_difference < 0) return absl::OkStatus();
  return InFile(options.path, DifferenceStatus(*log, *result));
}

}  // namespace

Command AddReplayCommand(CLI::App& app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* replay = app.add_subcommand(
      "replay",
      "Solve a log again, of gelenk play --record or gelenk retarget --live "
      "--record, and compare joint angles bit by bit");
  replay->add_option("LOG", options->path, "The log")
      ->required()
      ->option_text("");
  AddFormatOption(*replay, &options->format);
  replay->footer(
      "Examples:\n"
      "  gelenk play walk.bvh --record walk.log\n"
      "  gelenk replay walk.log\n"
      "  gelenk --server localhost:50051 replay walk.log --format json");
  return {replay, [options](const GlobalOptions& globals, std::string* output) {
            return RunReplay(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
