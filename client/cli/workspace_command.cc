// gelenk workspace: what an end effector can reach.
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/picture/workspace_picture.h"
#include "client/cli/service.h"
#include "client/cli/skeleton_file.h"
#include "client/cli/text/table.h"
#include "client/cli/uploaded_skeleton.h"
#include "client/cli/workspace/reach.h"

namespace gelenk::cli {
namespace {

struct WorkspaceCommandOptions {
  SkeletonFileOptions file;
  v1::ComputeWorkspaceRequest request;
  std::string out_path;
  std::string picture_path;
  Format format = Format::kTable;
};

Json PointJson(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

std::string PointText(const Eigen::Vector3d& point) {
  return absl::StrCat(Significant(point.x(), 6), " ", Significant(point.y(), 6),
                      " ", Significant(point.z(), 6));
}

std::string Text(const Reach& reach) {
  Facts facts;
  if (reach.annulus) {
    facts.Add("reach", "a ring, exact");
    facts.Add("center",
              absl::StrCat(PointText(reach.annulus->world_center), " m"));
    facts.Add("normal", PointText(reach.annulus->world_normal));
    facts.Add("from", absl::StrCat(
                          Significant(reach.annulus->inner_radius_m, 9), " m"));
    facts.Add("to", absl::StrCat(Significant(reach.annulus->outer_radius_m, 9),
                                 " m"));
    return facts.ToString();
  }
  const WorkspaceMap& map = reach.map;
  const Eigen::Vector3d extent = map.size.cast<double>() * map.voxel_size_m;
  facts.Add("reach", absl::StrCat("sampled by ", map.sample_count, " poses"));
  facts.Add("from", absl::StrCat(PointText(map.world_min), " m"));
  facts.Add("to", absl::StrCat(PointText(map.world_min + extent), " m"));
  facts.Add("voxels", absl::StrCat(map.voxels.size(), " of ",
                                   Significant(map.voxel_size_m, 4),
                                   " m reached, of ", map.size.x(), " x ",
                                   map.size.y(), " x ", map.size.z()));
  return facts.ToString();
}

Json ToJson(const Reach& reach) {
  Json json;
  if (reach.annulus) {
    json["annulus"] = {
        {"world_center_m", PointJson(reach.annulus->world_center)},
        {"world_normal", PointJson(reach.annulus->world_normal)},
        {"inner_radius_m", reach.annulus->inner_radius_m},
        {"outer_radius_m", reach.annulus->outer_radius_m}};
    return json;
  }
  const WorkspaceMap& map = reach.map;
  json["map"] = {{"world_min_m", PointJson(map.world_min)},
                 {"voxel_size_m", map.voxel_size_m},
                 {"size", {map.size.x(), map.size.y(), map.size.z()}},
                 {"reached_voxels", map.voxels.size()},
                 {"samples", map.sample_count}};
  return json;
}

absl::Status WriteFiles(const WorkspaceCommandOptions& options,
                        const Reach& reach) {
  if (!options.out_path.empty()) {
    const absl::Status status =
        WriteFile(options.out_path, PointCloudCsv(reach.map));
    if (!status.ok()) return status;
  }
  if (options.picture_path.empty()) return absl::OkStatus();
  const std::string& effector = options.request.end_effector_id();
  return WriteFile(options.picture_path,
                   reach.annulus ? WorkspacePictureSvg(*reach.annulus, effector)
                                 : WorkspacePictureSvg(reach.map, effector));
}

absl::Status RunWorkspace(const WorkspaceCommandOptions& options,
                          const GlobalOptions& globals, std::string* output) {
  const absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(
      options.file.path, options.file.unit_m, options.file.skin);
  if (!file.ok()) return file.status();
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const auto skeleton =
      UploadedSkeleton::Create((*service)->connection(), file->message);
  if (!skeleton.ok()) return skeleton.status();
  v1::ComputeWorkspaceRequest request = options.request;
  request.set_skeleton((*skeleton)->name());
  // A cloud of points has no exact form.
  if (!options.out_path.empty()) request.set_sampled(true);
  const absl::StatusOr<Reach> reach =
      AskForReach(*(*service)->connection(), request);
  if (!reach.ok()) return reach.status();
  *output +=
      options.format == Format::kJson ? JsonText(ToJson(*reach)) : Text(*reach);
  return WriteFiles(options, *reach);
}

}  // namespace

Command AddWorkspaceCommand(CLI::App& app) {
  auto options = std::make_shared<WorkspaceCommandOptions>();
  v1::ComputeWorkspaceRequest* request = &options->request;
  CLI::App* workspace =
      app.add_subcommand("workspace", "What an end effector can reach");
  AddSkeletonFileOptions(*workspace, &options->file);
  workspace
      ->add_option_function<std::string>(
          "--tip",
          [request](const std::string& id) {
            request->set_end_effector_id(id);
          },
          "End effector or joint")
      ->required()
      ->option_text("ID");
  workspace
      ->add_option_function<int>(
          "--samples", [request](int n) { request->set_sample_count(n); },
          "Poses to draw within the limits; default 100000")
      ->check(CLI::Range(1, kMaxWorkspaceSamples).description(""))
      ->option_text("N");
  workspace
      ->add_option_function<double>(
          "--voxel", [request](double m) { request->set_voxel_size_m(m); },
          "Edge of a voxel; default the largest extent / 64")
      ->check(Positive())
      ->option_text("M");
  workspace
      ->add_option_function<int64_t>(
          "--seed", [request](int64_t seed) { request->set_seed(seed); },
          "Of the draw; the same seed draws the same poses; default 0")
      ->option_text("N");
  workspace->add_flag_callback(
      "--sampled", [request] { request->set_sampled(true); },
      "A map also where the reach is known exactly");
  workspace
      ->add_option("--out", options->out_path,
                   "Write the reached voxels: x_m,y_m,z_m,reach_count,"
                   "mean_manipulability")
      ->option_text("FILE.csv");
  workspace->add_option("--picture", options->picture_path, "Draw the reach")
      ->check(EndsWith({".svg"}))
      ->option_text("FILE.svg");
  AddFormatOption(*workspace, &options->format);
  workspace->footer(
      "Example:\n"
      "  gelenk workspace arm.urdf --tip tool0 --picture reach.svg");
  return {workspace,
          [options](const GlobalOptions& globals, std::string* output) {
            return RunWorkspace(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
