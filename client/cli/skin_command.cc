// gelenk skin: surfaces on skeletons: bound, corrected, deformed, exported.
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/patient_call.h"
#include "client/cli/picture/mesh_picture.h"
#include "client/cli/service.h"
#include "client/cli/skin/binding_text.h"
#include "client/cli/skin/deformed_frames.h"
#include "client/cli/skin/exported_skin.h"
#include "client/cli/skin/served_skin.h"
#include "client/cli/skin/skin_demo.h"
#include "client/cli/skin/skin_options.h"
#include "client/cli/text/table.h"
#include "convert/geometry.h"

namespace gelenk::cli {
namespace {

// A picture of a clip shows so many of its frames.
constexpr size_t kPanels = 8;

using Connection = std::shared_ptr<client::Connection>;

// Assignments of an earlier `rebind`; none where there is no file yet.
absl::StatusOr<v1::LayeredVolumes> ReadAssignments(const std::string& path) {
  v1::LayeredVolumes volumes;
  if (path.empty() || !std::filesystem::exists(path)) return volumes;
  const absl::StatusOr<std::string> json = ReadFile(path);
  if (!json.ok()) return json.status();
  const auto parsed =
      google::protobuf::util::JsonStringToMessage(*json, &volumes);
  if (parsed.ok()) return volumes;
  return InFile(path,
                absl::InvalidArgumentError(std::string(parsed.message())));
}

absl::Status WriteAssignments(const v1::Binding& binding,
                              const std::string& path) {
  v1::LayeredVolumes volumes;
  *volumes.mutable_assignments() = binding.assignments();
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  std::string json;
  // Fails only for Any and malformed times, which there are none of.
  google::protobuf::util::MessageToJsonString(volumes, &json, options).ok();
  return WriteFile(path, json);
}

absl::StatusOr<std::unique_ptr<ServedSkin>> OpenSkin(
    const SkinOptions& options, const Connection& connection) {
  absl::StatusOr<v1::LayeredVolumes> volumes =
      ReadAssignments(options.assignments_path);
  if (!volumes.ok()) return volumes.status();
  return ServedSkin::Open(connection, options.source, options.keep_id,
                          *volumes);
}

void AppendWarnings(const ServedSkin& served, std::string* output) {
  for (const std::string& warning : served.warnings()) {
    absl::StrAppend(output, "warning: ", warning, "\n");
  }
  for (const std::string& warning : served.skin().warnings()) {
    absl::StrAppend(output, "warning: ", warning, "\n");
  }
}

absl::StatusOr<v1::Binding> ReadBinding(const Connection& connection,
                                        const std::string& name, bool whole) {
  v1::GetBindingRequest request;
  request.set_name(name);
  request.set_include_classes(whole);
  request.set_include_candidates(whole);
  return connection->Call(&SkinStub::GetBinding, request, PatientCall());
}

absl::Status RunBind(const SkinOptions& options, const Connection& connection,
                     bool whole, std::string* output) {
  const auto served = OpenSkin(options, connection);
  if (!served.ok()) return served.status();
  const v1::Skin& skin = (*served)->skin();
  if (!skin.has_binding_counts()) {
    absl::StrAppend(output, skin.name(), ": ", skin.vertex_count(),
                    " vertices, deformed by weights: nothing is bound\n");
    return absl::OkStatus();
  }
  const absl::StatusOr<v1::Binding> binding = ReadBinding(
      connection, absl::StrCat(skin.name(), "@", skin.revision()), whole);
  if (!binding.ok()) return binding.status();
  if (options.format == Format::kJson) {
    *output += JsonText(BindingJson(skin, *binding));
    return absl::OkStatus();
  }
  *output += BindingText(skin, *binding);
  AppendWarnings(**served, output);
  if (!options.keep_id.empty()) {
    absl::StrAppend(output, "stays as ", skin.name(), "\n");
  }
  return absl::OkStatus();
}

absl::Status RunUndo(const SkinOptions& options, const Connection& connection,
                     std::string* output) {
  if (!absl::StartsWith(options.source.path, "skins/")) {
    return absl::InvalidArgumentError(
        "--undo: want a skin that stays on a server, skins/NAME");
  }
  const auto served = OpenSkin(options, connection);
  if (!served.ok()) return served.status();
  const v1::Skin& skin = (*served)->skin();
  if (skin.base_revision() == 0) {
    return absl::FailedPreconditionError(
        absl::StrCat(skin.name(), ": there is nothing to undo"));
  }
  v1::RollbackSkinRequest request;
  request.set_name(absl::StrCat(skin.name(), "@", skin.base_revision()));
  const absl::StatusOr<v1::Skin> undone =
      connection->Call(&SkinStub::RollbackSkin, request, PatientCall());
  if (!undone.ok()) return undone.status();
  absl::StrAppend(output, skin.name(), " is as at revision ",
                  skin.base_revision(), " again, as revision ",
                  undone->revision(), "\n");
  return absl::OkStatus();
}

absl::Status RunRebind(const SkinOptions& options, const Connection& connection,
                       std::string* output) {
  if (options.undo) return RunUndo(options, connection, output);
  absl::StatusOr<v1::VertexSelector> selector = SelectorOf(options.selector);
  if (!selector.ok()) return selector.status();
  const auto served = OpenSkin(options, connection);
  if (!served.ok()) return served.status();
  v1::RebindVerticesRequest request;
  request.set_name((*served)->skin().name());
  *request.mutable_selector() = *std::move(selector);
  request.set_link_id(options.link_id);
  request.set_scope(options.scope);
  request.set_dry_run(options.dry_run);
  const absl::StatusOr<v1::RebindVerticesResponse> response =
      connection->Call(&SkinStub::RebindVertices, request, PatientCall());
  if (!response.ok()) return response.status();
  *output += RebindText(*response, options.dry_run);
  if (options.dry_run || options.assignments_path.empty()) {
    return absl::OkStatus();
  }
  const absl::StatusOr<v1::Binding> binding =
      ReadBinding(connection, response->skin().name(), false);
  if (!binding.ok()) return binding.status();
  const absl::Status status =
      WriteAssignments(*binding, options.assignments_path);
  if (!status.ok()) return status;
  absl::StrAppend(output, "wrote ", options.assignments_path, "\n");
  return absl::OkStatus();
}

// The poses that are asked for; else the rest pose.
absl::StatusOr<PoseList> PosesFor(const SkinOptions& options,
                                  const v1::Skeleton& skeleton) {
  absl::StatusOr<PoseList> list = PosesOf(options.poses);
  if (list.ok() && list->poses.empty()) {
    *list->poses.emplace_back().mutable_pose() = skeleton.rest_pose();
  }
  return list;
}

std::string FramesText(const DeformedFrames& deformed) {
  int64_t bytes = 0, most = 0;
  int keyframes = 0, folded = 0, clamped = 0;
  for (const DeformedFrame& frame : deformed.frames) {
    bytes += frame.byte_size;
    most = std::max(most, frame.byte_size);
    keyframes += frame.is_keyframe ? 1 : 0;
    folded += frame.fold_count > 0 ? 1 : 0;
    clamped += frame.clamped_count > 0 ? 1 : 0;
  }
  const auto count = static_cast<int64_t>(deformed.frames.size());
  Facts facts;
  facts.Add("frames", absl::StrCat(count, ", ", keyframes, " keyframes"));
  facts.Add("bytes a frame", absl::StrCat(bytes / count, ", at most ", most));
  facts.Add("frames that fold", absl::StrCat(folded));
  facts.Add("with clamped muscles", absl::StrCat(clamped));
  return facts.ToString();
}

absl::Status DrawFrames(const DeformedFrames& deformed,
                        const v1::Skeleton& skeleton, const std::string& title,
                        const std::string& path) {
  if (deformed.frames.front().positions.empty()) {
    return absl::InvalidArgumentError(
        "--picture: control planes are drawn by who deforms by them");
  }
  std::vector<MeshPanel> panels;
  const size_t count = std::min(kPanels, deformed.frames.size());
  for (size_t i = 0; i < count; ++i) {
    const size_t frame =
        count == 1 ? 0 : i * (deformed.frames.size() - 1) / (count - 1);
    panels.push_back(
        {absl::StrCat("frame ", frame), deformed.frames[frame].positions});
  }
  MeshView view;
  view.up = convert::FromProto(skeleton.up());
  if (std::abs(view.up.z()) > 0.9)
    view.toward_viewer = -Eigen::Vector3d::UnitY();
  return WriteFile(path,
                   MeshPictureSvg(title, deformed.triangles, panels, view));
}

absl::Status RunDeform(const SkinOptions& options, const Connection& connection,
                       std::string* output) {
  const auto served = OpenSkin(options, connection);
  if (!served.ok()) return served.status();
  const absl::StatusOr<v1::Skeleton> skeleton = (*served)->ReadSkeleton();
  if (!skeleton.ok()) return skeleton.status();
  const absl::StatusOr<PoseList> list = PosesFor(options, *skeleton);
  if (!list.ok()) return list.status();
  const absl::StatusOr<DeformedFrames> deformed = DeformSkin(
      *connection, (*served)->skin().name(), list->poses, options.encoding);
  if (!deformed.ok()) return deformed.status();
  *output += FramesText(*deformed);
  AppendWarnings(**served, output);
  if (options.picture_path.empty()) return absl::OkStatus();
  const absl::Status status =
      DrawFrames(*deformed, *skeleton, (*served)->skin().display_name(),
                 options.picture_path);
  if (!status.ok()) return status;
  absl::StrAppend(output, "wrote ", options.picture_path, "\n");
  return absl::OkStatus();
}

absl::Status RunExport(const SkinOptions& options, const Connection& connection,
                       std::string* output) {
  const auto served = OpenSkin(options, connection);
  if (!served.ok()) return served.status();
  const absl::StatusOr<PoseList> list = PosesOf(options.poses);
  if (!list.ok()) return list.status();
  const absl::StatusOr<ExportedSkin> exported = ExportSkin(
      *connection, (*served)->skin().name(), list->poses, list->frame_time);
  if (!exported.ok()) return exported.status();
  const absl::Status status = WriteFile(options.out_path, exported->glb);
  if (!status.ok()) return status;
  absl::StrAppend(output, "wrote ", options.out_path, ", ",
                  exported->glb.size(), " bytes\n");
  if (exported->inexact_vertex_count > 0) {
    absl::StrAppend(output, exported->inexact_vertex_count,
                    " vertices near branches are not exact\n");
  }
  return absl::OkStatus();
}

absl::Status RunSkin(const SkinOptions& options, const GlobalOptions& globals,
                     std::string* output) {
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const Connection& connection = (*service)->connection();
  if (options.bind->parsed()) {
    return RunBind(options, connection, false, output);
  }
  if (options.report->parsed()) {
    return RunBind(options, connection, true, output);
  }
  if (options.rebind->parsed()) return RunRebind(options, connection, output);
  if (options.deform->parsed()) return RunDeform(options, connection, output);
  if (options.demo->parsed()) {
    return RunSkinDemo(options.demonstration, connection, output);
  }
  return RunExport(options, connection, output);
}

}  // namespace

Command AddSkinCommand(CLI::App& app) {
  auto options = std::make_shared<SkinOptions>();
  CLI::App* skin = app.add_subcommand(
      "skin", "Surfaces on skeletons: bound, corrected, deformed, exported");
  AddSkinSteps(*skin, options.get());
  return {skin, [options](const GlobalOptions& globals, std::string* output) {
            return RunSkin(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
