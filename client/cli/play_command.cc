// gelenk play: a recorded clip through the service.
#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "client/cli/bvh_clip.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/picture/play_picture.h"
#include "client/cli/play/clip_goals.h"
#include "client/cli/play/clip_player.h"
#include "client/cli/play/play_report.h"
#include "client/cli/progress_bar.h"
#include "client/cli/service.h"
#include "client/cli/skeleton_file.h"

namespace gelenk::cli {
namespace {

// A recording's own noise is about this large.
constexpr Tolerance kPlayTolerance = {1e-3, 1e-2};

struct PlayOptions {
  std::string path;
  std::optional<double> unit_m;
  std::string limits = kClipLimits;
  std::string tolerance;
  PlayerOptions player;
  std::string out_path;
  std::string picture_path;
  Format format = Format::kTable;
};

absl::StatusOr<Playback> Prepare(const PlayOptions& options,
                                 const BvhClip& clip,
                                 const LimitedSkeleton& limited) {
  Playback playback;
  playback.clip_name = BaseName(options.path);
  playback.skeleton = limited.skeleton;
  playback.body = FindBodyParts(*playback.skeleton);
  playback.frame_time = clip.frame_time();
  playback.tolerance = kPlayTolerance;
  if (!options.tolerance.empty()) {
    const auto tolerance = ParseTolerance(options.tolerance, kPlayTolerance);
    if (!tolerance.ok()) return tolerance.status();
    playback.tolerance = *tolerance;
  }
  playback.goals = GoalsFor(*playback.skeleton, playback.body);
  playback.clip_poses = clip.poses;
  return playback;
}

absl::Status Play(const PlayOptions& options, const std::string& server,
                  Playback* playback) {
  const auto service = Service::Open(server);
  if (!service.ok()) return service.status();
  ProgressBar progress(playback->clip_name, playback->clip_poses.cols());
  return PlayClip((*service)->connection(), options.player,
                  [&progress](int done) { progress.Update(done); }, playback);
}

absl::Status WriteFiles(const PlayOptions& options, const BvhClip& clip,
                        PlayReport* report) {
  const Playback& playback = *report->playback;
  if (!options.out_path.empty()) {
    absl::Status status =
        WriteBvhClip(clip, playback.answered_poses, options.out_path);
    if (!status.ok()) return status;
    report->written.push_back(options.out_path);
  }
  if (!options.picture_path.empty()) {
    const bool is_page =
        absl::EndsWithIgnoreCase(options.picture_path, ".html");
    absl::Status status =
        WriteFile(options.picture_path,
                  is_page ? PlayPictureHtml(playback, *report->residuals)
                          : PlayPictureSvg(playback, *report->residuals));
    if (!status.ok()) return status;
    report->written.push_back(options.picture_path);
  }
  if (!options.player.record_path.empty()) {
    report->written.push_back(options.player.record_path);
  }
  return absl::OkStatus();
}

absl::Status RunPlay(const PlayOptions& options, const GlobalOptions& globals,
                     std::string* output) {
  const absl::StatusOr<BvhClip> clip =
      ReadBvhClip(options.path, options.unit_m);
  if (!clip.ok()) return clip.status();
  if (clip->frame_count() == 0) {
    return InFile(options.path,
                  absl::InvalidArgumentError("has no frames to play"));
  }
  const auto limited = ChooseLimits(*clip, options.limits);
  if (!limited.ok()) return limited.status();
  absl::StatusOr<Playback> playback = Prepare(options, *clip, *limited);
  if (!playback.ok()) return playback.status();
  absl::Status status = Play(options, globals.server, &*playback);
  if (!status.ok()) return status;

  const Residuals residuals = MeasureResiduals(*playback);
  PlayReport report;
  report.playback = &*playback;
  report.residuals = &residuals;
  report.limits = &*limited;
  report.summary = Summarize(*playback, residuals);
  report.unit_m = clip->import.unit_m;
  report.first_frame_jump =
      FindFirstFrameJump(*playback->skeleton, clip->poses);
  status = WriteFiles(options, *clip, &report);
  *output += options.format == Format::kJson ? JsonText(PlayReportJson(report))
                                             : PlayReportText(report);
  status.Update(CheckPlayed(report));
  return status;
}

void AddStreamOptions(CLI::App& play, PlayerOptions* options) {
  AddChoice<v1::FramePolicy>(play, "--policy", &options->policy,
                             {{"every", v1::FRAME_POLICY_EVERY_FRAME},
                              {"latest", v1::FRAME_POLICY_LATEST_WINS}},
                             "Solve every frame (default), or the latest when "
                             "frames come faster than answers");
  play.add_option("--batch", options->batch,
                  "Frames under way at a time (default 32); 1 waits for each "
                  "answer")
      ->check(CLI::Range(1, 1024).description(""))
      ->option_text("N");
  play.add_option("--fps", options->fps,
                  "Send so many frames a second; default: as fast as answered")
      ->check(Positive())
      ->option_text("F");
}

}  // namespace

Command AddPlayCommand(CLI::App& app) {
  auto options = std::make_shared<PlayOptions>();
  CLI::App* play = app.add_subcommand(
      "play",
      "Play motion capture through the service: hands, feet, head and hips of "
      "every frame go in as targets, joint angles come back");
  play->add_option("FILE", options->path, "A motion capture file (.bvh)")
      ->required()
      ->option_text("");
  play->add_option("--out", options->out_path,
                   "Write the answers as BVH, in the clip's own form")
      ->option_text("OUT.bvh");
  play->add_option("--picture", options->picture_path,
                   "Draw targets and answers over time")
      ->option_text("OUT.svg|OUT.html");
  play->add_option("--record", options->player.record_path,
                   "Write frames and answers as a log for gelenk replay")
      ->option_text("LOG");
  play->add_option("--limits", options->limits,
                   "Joint limits: the clip's range ± 5° (default), none, or "
                   "those of a skeleton file")
      ->option_text("clip|none|FILE.json");
  play->add_option("--tolerance", options->tolerance,
                   "Errors that count as reached; default 1e-3 m, 1e-2 rad")
      ->check(Parses([](const std::string& text) {
        return ParseTolerance(text, kPlayTolerance);
      }))
      ->option_text("M[,RAD]");
  play->add_option("--unit", options->unit_m,
                   "Metres per unit of the file; default: guessed from the "
                   "body's height")
      ->check(Positive())
      ->option_text("M");
  AddStreamOptions(*play, &options->player);
  AddFormatOption(*play, &options->format);
  play->footer(
      "Examples:\n"
      "  gelenk play walk.bvh --out solved.bvh --picture solved.svg\n"
      "  gelenk --server localhost:50051 play walk.bvh --fps 120 --format "
      "json");
  return {play, [options](const GlobalOptions& globals, std::string* output) {
            return RunPlay(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
