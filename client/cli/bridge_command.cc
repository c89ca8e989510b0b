// gelenk bridge: live motion of other programs onto another body.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "client/cli/command.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/service.h"
#include "client/cli/vmc/udp_socket.h"
#include "client/cli/vmc/vmc_bridge.h"
#include "gelenk/motion/frame_conditioner.h"
#include "gelenk/retarget/tracker_goals.h"

namespace gelenk::cli {
namespace {

struct BridgeOptions {
  std::string listen;
  std::string onto;
  std::string send;
  std::optional<double> unit_m;
  std::string map_path;
  std::vector<std::string> trackers;
  double height_m = kHumanoidHeightM;
  bool begins_in_t_pose = false;
  std::optional<double> fill_s;
  std::optional<double> seconds;
  Format format = Format::kTable;
};

std::atomic<bool>& Interrupted() {
  static std::atomic<bool> interrupted = false;
  return interrupted;
}

void OnSignal(int) { Interrupted() = true; }

std::string CountsText(const VmcBridgeCounts& counts, Format format) {
  if (format == Format::kJson) {
    return JsonText({{"packets", counts.packets},
                     {"malformed_packets", counts.malformed_packets},
                     {"refused_messages", counts.refused_messages},
                     {"frames_in", counts.frames_in},
                     {"frames_out", counts.frames_out},
                     {"refused_frames", counts.refused_frames}});
  }
  return absl::StrCat(counts.packets, " packets, ", counts.malformed_packets,
                      " malformed; ", counts.refused_messages,
                      " messages refused; ", counts.frames_in, " frames in, ",
                      counts.frames_out, " out, ", counts.refused_frames,
                      " refused\n");
}

// SERIAL=PART, one each.
absl::StatusOr<std::optional<VmcTrackers>> TrackersFrom(
    const BridgeOptions& options) {
  if (options.trackers.empty()) return std::optional<VmcTrackers>();
  VmcTrackers trackers;
  trackers.height_m = options.height_m;
  trackers.begins_in_t_pose = options.begins_in_t_pose;
  std::set<std::string> parts;
  TrackerFrame frame;
  for (const std::string& text : options.trackers) {
    const size_t sign = text.rfind('=');
    const std::string part =
        sign == std::string::npos ? "" : text.substr(sign + 1);
    if (FindTracker(part, frame) == nullptr || !parts.insert(part).second) {
      return absl::InvalidArgumentError(absl::StrCat(
          "--tracker: want SERIAL=PART, each of ",
          absl::StrJoin(kTrackerIds, ", "), " once, got \"", text, "\""));
    }
    trackers.part_of_serial[text.substr(0, sign)] = part;
  }
  if (parts.count("head") == 0) {
    return absl::InvalidArgumentError("--tracker: want one that is the head");
  }
  return std::optional<VmcTrackers>(std::move(trackers));
}

absl::Status RunVmc(const BridgeOptions& options, const std::string& server,
                    std::string* output) {
  absl::StatusOr<std::optional<VmcTrackers>> trackers = TrackersFrom(options);
  if (!trackers.ok()) return trackers.status();
  MapFile map;
  if (!options.map_path.empty()) {
    absl::StatusOr<MapFile> read = ReadMapFile(options.map_path);
    if (!read.ok()) return read.status();
    map = *std::move(read);
  }
  absl::StatusOr<BodyFile> target =
      ReadBodyFile(options.onto, options.unit_m, map.target);
  if (!target.ok()) return target.status();
  absl::StatusOr<std::unique_ptr<UdpSocket>> in =
      UdpSocket::Listen(options.listen);
  if (!in.ok()) return in.status();
  absl::StatusOr<std::unique_ptr<UdpSocket>> out =
      UdpSocket::Connect(options.send);
  if (!out.ok()) return out.status();
  const absl::StatusOr<std::unique_ptr<Service>> service =
      Service::Open(server);
  if (!service.ok()) return service.status();
  std::fprintf(stderr, "gelenk: VMC at port %d\n", (*in)->port());
  std::optional<absl::Duration> fill_interval;
  if (options.fill_s) fill_interval = absl::Seconds(*options.fill_s);
  VmcBridge bridge((*service)->connection(), *std::move(target), *std::move(in),
                   *std::move(out), *std::move(trackers), fill_interval);
  std::signal(SIGINT, OnSignal);
  std::signal(SIGTERM, OnSignal);
  const absl::Time deadline =
      options.seconds ? absl::Now() + absl::Seconds(*options.seconds)
                      : absl::InfiniteFuture();
  const absl::Status status = bridge.Run(deadline, Interrupted());
  absl::StrAppend(output, CountsText(bridge.counts(), options.format));
  return status;
}

}  // namespace

Command AddBridgeCommand(CLI::App& app) {
  auto options = std::make_shared<BridgeOptions>();
  CLI::App* bridge = app.add_subcommand(
      "bridge", "Live motion of another program onto another body");
  bridge->require_subcommand(1);
  CLI::App* vmc = bridge->add_subcommand(
      "vmc", "The Virtual Motion Capture protocol, in and out");
  vmc->add_option("--listen", options->listen,
                  "Where motion comes in: a port of this machine (39539, say), "
                  "or host:port")
      ->required()
      ->option_text("PORT");
  vmc->add_option("--onto", options->onto,
                  "The body that moves: a model (.glb, .gltf, VRM too), "
                  "motion capture (.bvh), a robot (.urdf), a skeleton (.json), "
                  "or humanoid")
      ->required()
      ->option_text("FILE|humanoid");
  vmc->add_option("--send", options->send, "Where its motion goes")
      ->required()
      ->option_text("HOST:PORT");
  vmc->add_option("--map", options->map_path,
                  "Who plays what in FILE where the proposal is wrong: "
                  "\"target\" of `gelenk map --format json`")
      ->option_text("MAP.json");
  vmc->add_option("--unit", options->unit_m,
                  "Metres per unit of FILE; default: guessed")
      ->check(Positive())
      ->option_text("M");
  vmc->add_option("--tracker", options->trackers,
                  "Follow this headset, controller or tracker in place of "
                  "bones; PART is head, left_hand, right_hand, waist, "
                  "left_foot or right_foot. May come several times")
      ->option_text("SERIAL=PART");
  vmc->add_option("--height", options->height_m,
                  "Of the person with trackers, m; default: 1.75")
      ->check(Positive())
      ->option_text("M");
  vmc->add_flag("--t-pose", options->begins_in_t_pose,
                "The first frame of the trackers shows a T-pose at the origin, "
                "facing forward: tells how they are worn");
  vmc->add_option("--fill", options->fill_s,
                  "When no motion came for so long, it goes on and eases to "
                  "rest, a frame each S; 0.002 to 10; default: it stops")
      ->check(CLI::Range(kMinFillInterval_s, kMaxFillInterval_s))
      ->option_text("S");
  vmc->add_option("--seconds", options->seconds,
                  "End after so long; default: when interrupted")
      ->check(Positive())
      ->option_text("S");
  AddFormatOption(*vmc, &options->format);
  vmc->footer(
      "Example:\n  gelenk bridge vmc --listen 39539 --onto hero.glb --send "
      "127.0.0.1:39540");
  return {bridge, [options](const GlobalOptions& global, std::string* output) {
            return RunVmc(*options, global.server, output);
          }};
}

}  // namespace gelenk::cli
