// gelenk skin: surfaces on skeletons: bound, corrected, deformed, exported.
#include <google/protobuf/util/json_util.h>

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
#include "client/cli/service.h"
#include "client/cli/skin/binding_text.h"
#include "client/cli/skin/deform_step.h"
#include "client/cli/skin/exported_skin.h"
#include "client/cli/skin/served_skin.h"
#include "client/cli/skin/skin_demo.h"
#include "client/cli/skin/skin_list.h"
#include "client/cli/skin/skin_options.h"

namespace gelenk::cli {
namespace {

using Connection = std::shared_ptr<client::Connection>;

// Assignments of an earlier `rebind`, which begins the file where there is none
// yet.
absl::StatusOr<v1::LayeredVolumes> ReadAssignments(const std::string& path,
                                                   bool may_be_missing) {
  v1::LayeredVolumes volumes;
  if (path.empty() || (may_be_missing && !std::filesystem::exists(path))) {
    return volumes;
  }
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
      ReadAssignments(options.assignments_path, options.rebind->parsed());
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
  // Only of a mesh in volumes.
  v1::Binding binding;
  if (skin.has_binding_counts()) {
    absl::StatusOr<v1::Binding> read = ReadBinding(
        connection, absl::StrCat(skin.name(), "@", skin.revision()), whole);
    if (!read.ok()) return read.status();
    binding = *std::move(read);
  }
  if (options.format == Format::kJson) {
    Json json = BindingJson(skin, binding);
    for (const std::string& warning : (*served)->warnings()) {
      json["skin"]["warnings"].push_back(warning);
    }
    *output += JsonText(json);
    return absl::OkStatus();
  }
  *output += BindingText(skin, binding);
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

absl::Status RunExport(const SkinOptions& options, const Connection& connection,
                       std::string* output) {
  const auto served = OpenSkin(options, connection);
  if (!served.ok()) return served.status();
  const absl::StatusOr<v1::Skeleton> skeleton = (*served)->ReadSkeleton();
  if (!skeleton.ok()) return skeleton.status();
  const absl::StatusOr<PoseList> list = PosesOf(options.poses, *skeleton);
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

// What only a server keeps.
absl::Status CheckServer(const SkinOptions& options,
                         const GlobalOptions& globals) {
  if (!globals.server.empty()) {
    if (options.keep_id.empty() ||
        !absl::StartsWith(options.source.path, "skins/")) {
      return absl::OkStatus();
    }
    return absl::InvalidArgumentError(
        absl::StrCat("--keep: ", options.source.path, " is there already"));
  }
  if (!options.keep_id.empty()) {
    return absl::InvalidArgumentError(
        "--keep: want a --server that keeps the skin");
  }
  if (options.list->parsed() || options.remove->parsed()) {
    return absl::InvalidArgumentError("--server: want the one with the skins");
  }
  return absl::OkStatus();
}

absl::Status RunSkin(const SkinOptions& options, const GlobalOptions& globals,
                     std::string* output) {
  if (absl::Status status = CheckServer(options, globals); !status.ok()) {
    return status;
  }
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
  if (options.deform->parsed()) {
    const auto served = OpenSkin(options, connection);
    if (!served.ok()) return served.status();
    absl::Status status = RunDeform(options, *connection, **served, output);
    if (status.ok()) AppendWarnings(**served, output);
    return status;
  }
  if (options.list->parsed()) {
    return PrintSkins(*connection, options.format, output);
  }
  if (options.remove->parsed()) {
    return DeleteSkin(*connection, options.source.path);
  }
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
