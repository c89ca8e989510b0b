// gelenk retarget: motion onto another body. gelenk map: who plays what.
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/motion/clip_writer.h"
#include "client/cli/motion/follower.h"
#include "client/cli/motion/motion_picture.h"
#include "client/cli/motion/quality_text.h"
#include "client/cli/motion/served_clips.h"
#include "client/cli/service.h"
#include "client/cli/text/table.h"
#include "convert/joint_map.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk::cli {
namespace {

struct RetargetCommandOptions {
  std::string path;
  MotionFileOptions motion;
  std::string onto;
  std::string out_path;
  std::string map_path;
  std::string picture_path;
  std::string record_path;
  bool live = false;
  Format format = Format::kTable;
};

struct MapOptions {
  std::string path;
  std::string onto;
  Format format = Format::kTable;
};

// Through a session, as a live source is retargeted.
absl::StatusOr<Eigen::MatrixXd> RetargetLive(const std::string& server,
                                             const BodyFile& source,
                                             const BodyFile& target,
                                             const std::string& record_path) {
  const absl::StatusOr<std::unique_ptr<Service>> service =
      Service::Open(server);
  if (!service.ok()) return service.status();
  return FollowClip((*service)->connection(), source, target, record_path);
}

// By MotionService: both bodies go there, the motion comes back.
absl::StatusOr<Eigen::MatrixXd> RetargetServed(
    const std::string& server, const RetargetCommandOptions& options,
    const BodyFile& source, const BodyFile& target) {
  const auto clips = ServedClips::Open(server);
  if (!clips.ok()) return clips.status();
  const auto clip = (*clips)->Upload(options.path, options.motion);
  if (!clip.ok()) return clip.status();
  v1::RetargetClipRequest request;
  request.set_clip(clip->name());
  *request.mutable_joint_map() = convert::ToProto(source.roles, target.roles);
  if (target.has_motion()) {
    const auto onto = (*clips)->Upload(options.onto);
    if (!onto.ok()) return onto.status();
    request.mutable_target()->set_clip(onto->name());
  } else {
    const auto onto = (*clips)->Upload(*target.model->skeleton);
    if (!onto.ok()) return onto.status();
    request.mutable_target()->set_skeleton(*onto);
  }
  const auto made = (*clips)->Retarget(request);
  if (!made.ok()) return made.status();
  return (*clips)->Frames(made->name(), target.model->skeleton);
}

absl::StatusOr<Eigen::MatrixXd> Retarget(const RetargetCommandOptions& options,
                                         const std::string& server,
                                         const BodyFile& source,
                                         const BodyFile& target) {
  if (options.live) {
    return RetargetLive(server, source, target, options.record_path);
  }
  if (!server.empty()) return RetargetServed(server, options, source, target);
  return RetargetBody(source, target.model, LookAhead::kWholeClip, {});
}

absl::Status RunRetarget(const RetargetCommandOptions& options,
                         const std::string& server, std::string* output) {
  MapFile map;
  if (!options.map_path.empty()) {
    absl::StatusOr<MapFile> read = ReadMapFile(options.map_path);
    if (!read.ok()) return read.status();
    map = *std::move(read);
  }
  const absl::StatusOr<BodyFile> source =
      ReadMovingBodyFile(options.path, options.motion, map.source);
  if (!source.ok()) return source.status();
  if (!source->has_motion()) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", options.path, "\": no motion to retarget"));
  }
  const absl::StatusOr<BodyFile> target =
      ReadBodyFile(options.onto, std::nullopt, map.target);
  if (!target.ok()) return target.status();
  const absl::StatusOr<Eigen::MatrixXd> positions =
      Retarget(options, server, *source, *target);
  if (!positions.ok()) return positions.status();
  const absl::StatusOr<MotionClip> clip = ClipFromFrames(
      target->model->skeleton, *positions,
      {.name = source->name, .frame_time_s = source->frame_time_s});
  if (!clip.ok()) return clip.status();
  if (absl::Status status = WriteClip(
          *clip, target->clip ? &*target->clip : nullptr, options.out_path);
      !status.ok()) {
    return status;
  }
  BodyFile made = *target;
  made.positions = *positions;
  made.frame_time_s = source->frame_time_s;
  const absl::StatusOr<MeasuredMotion> measured = MeasureBody(made, &*source);
  if (!measured.ok()) return measured.status();
  std::vector<std::string> written = {options.out_path};
  if (!options.picture_path.empty()) {
    if (absl::Status status =
            WriteMotionPicture(made, &*source, options.picture_path);
        !status.ok()) {
      return status;
    }
    written.push_back(options.picture_path);
  }
  if (!options.record_path.empty()) written.push_back(options.record_path);
  if (options.format == Format::kJson) {
    Json json = MeasuredJson(*measured);
    json["frames"] = positions->cols();
    json["source_notes"] = source->notes;
    json["target_notes"] = target->notes;
    json["written"] = written;
    *output += JsonText(json);
    return absl::OkStatus();
  }
  for (const BodyFile* body : {&*source, &*target}) {
    for (const std::string& note : body->notes) {
      absl::StrAppend(output, body->name, ": ", note, "\n");
    }
  }
  absl::StrAppend(output, MeasuredText(*measured));
  for (const std::string& path : written) {
    absl::StrAppend(output, "wrote ", path, "\n");
  }
  return absl::OkStatus();
}

Json EntriesJson(const BodyFile& body) {
  Json list = Json::array();
  for (const JointMapEntry& entry :
       EntriesOf(body.model->map, *body.model->skeleton)) {
    list.push_back({{"role", entry.role},
                    {"joint", entry.joint_id},
                    {"confidence", entry.confidence},
                    {"evidence", entry.evidence}});
  }
  return list;
}

std::string EntriesText(const BodyFile& body) {
  Table table({{"ROLE"}, {"JOINT"}, {"CONFIDENCE", Align::kRight}, {"BY"}});
  for (const JointMapEntry& entry :
       EntriesOf(body.model->map, *body.model->skeleton)) {
    table.AddRow({entry.role, entry.joint_id, Fixed(entry.confidence, 2),
                  entry.evidence});
  }
  std::string text = absl::StrCat(body.name, "\n", table.ToString());
  for (const std::string& note : body.notes) {
    absl::StrAppend(&text, note, "\n");
  }
  return text;
}

absl::Status RunMap(const MapOptions& options, std::string* output) {
  const absl::StatusOr<BodyFile> source =
      ReadBodyFile(options.path, std::nullopt);
  if (!source.ok()) return source.status();
  std::optional<BodyFile> target;
  if (!options.onto.empty()) {
    absl::StatusOr<BodyFile> read = ReadBodyFile(options.onto, std::nullopt);
    if (!read.ok()) return read.status();
    target = *std::move(read);
  }
  if (options.format == Format::kJson) {
    Json json = {{"source", EntriesJson(*source)}};
    if (target) json["target"] = EntriesJson(*target);
    *output += JsonText(json);
    return absl::OkStatus();
  }
  *output += EntriesText(*source);
  if (target) absl::StrAppend(output, "\n", EntriesText(*target));
  return absl::OkStatus();
}

constexpr char kBody[] =
    "Motion capture (.bvh, .asf), a robot (.urdf), a model (.gltf, .glb), a "
    "skeleton (.json), or humanoid, a body of our own";

}  // namespace

Command AddRetargetCommand(CLI::App& app) {
  auto options = std::make_shared<RetargetCommandOptions>();
  CLI::App* retarget = app.add_subcommand(
      "retarget", "A clip's motion onto another body, feet planted");
  retarget
      ->add_option("FILE", options->path,
                   "Motion capture (.bvh, .amc), or a model with an animation "
                   "(.gltf, .glb)")
      ->required()
      ->option_text("");
  retarget->add_option("--onto", options->onto, kBody)
      ->required()
      ->option_text("FILE|humanoid");
  retarget
      ->add_option("--out", options->out_path,
                   "What comes out: .bvh, .gltf or .glb")
      ->required()
      ->option_text("FILE");
  retarget
      ->add_option("--map", options->map_path,
                   "Who plays what where the proposal is wrong, as `gelenk map "
                   "--format json` prints it; a role with an empty joint is "
                   "nobody's")
      ->option_text("MAP.json");
  CLI::Option* live = retarget->add_flag(
      "--live", options->live,
      "Frame by frame without look-ahead, through a session as a live source "
      "(of --server, or one of its own)");
  retarget
      ->add_option("--record", options->record_path,
                   "Write frames and answers as a log for gelenk replay")
      ->needs(live)
      ->option_text("LOG");
  retarget
      ->add_option("--unit", options->motion.unit_m,
                   "Metres per unit of FILE; default: guessed of BVH, 1 of "
                   "glTF")
      ->check(Positive())
      ->option_text("M");
  AddAnimationOption(*retarget, "--animation", &options->motion.animation);
  AddSkeletonOption(*retarget, &options->motion.skeleton_path);
  retarget
      ->add_option("--picture", options->picture_path,
                   "Both motions as figures over time, with their contacts")
      ->check(EndsWith({".svg"}))
      ->option_text("SVG");
  AddFormatOption(*retarget, &options->format);
  retarget->footer(
      "Example:\n  gelenk retarget walk.bvh --onto humanoid --out out.bvh");
  return {retarget,
          [options](const GlobalOptions& global, std::string* output) {
            return RunRetarget(*options, global.server, output);
          }};
}

Command AddMapCommand(CLI::App& app) {
  auto options = std::make_shared<MapOptions>();
  CLI::App* map = app.add_subcommand(
      "map", "Which joint plays which role of a body, and how sure that is");
  map->excludes(app.get_option("--server"));
  map->add_option("FILE", options->path, kBody)->required()->option_text("");
  map->add_option("ONTO", options->onto, "A second one")->option_text("");
  AddFormatOption(*map, &options->format);
  map->footer("Example:\n  gelenk map walk.bvh humanoid");
  return {map, [options](const GlobalOptions&, std::string* output) {
            return RunMap(*options, output);
          }};
}

}  // namespace gelenk::cli
