// gelenk dh: the Denavit-Hartenberg table of a chain.
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/command.h"
#include "client/cli/service.h"
#include "client/cli/skeleton_file.h"
#include "client/cli/text/table.h"
#include "client/cli/uploaded_skeleton.h"

namespace gelenk::cli {
namespace {

struct DhOptions {
  SkeletonFileOptions file;
  std::string tip;
  std::string base;
  v1::DhTable::Convention convention = v1::DhTable::CONVENTION_STANDARD;
  Format format = Format::kTable;
};

std::string TypeName(v1::JointType type) {
  return type == v1::JOINT_TYPE_PRISMATIC ? "prismatic" : "revolute";
}

Json FrameJson(const v1::RigidTransform& frame) {
  const v1::Vector3& t = frame.translation();
  const v1::Quaternion& r = frame.rotation();
  return {{"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {r.x(), r.y(), r.z(), r.w()}}};
}

std::string FrameText(absl::string_view name, const v1::RigidTransform& frame) {
  const v1::Vector3& t = frame.translation();
  const v1::Quaternion& r = frame.rotation();
  return absl::StrCat(name, "  m ", Fixed(t.x(), 6), " ", Fixed(t.y(), 6), " ",
                      Fixed(t.z(), 6), "  x y z w ", Fixed(r.x(), 6), " ",
                      Fixed(r.y(), 6), " ", Fixed(r.z(), 6), " ",
                      Fixed(r.w(), 6), "\n");
}

std::string TableText(const v1::DhTable& dh) {
  Table table({{"row"},
               {"q"},
               {"a m", Align::kRight},
               {"alpha rad", Align::kRight},
               {"d m", Align::kRight},
               {"theta rad", Align::kRight}});
  for (int i = 0; i < dh.rows_size(); ++i) {
    const v1::DhRow& row = dh.rows(i);
    table.AddRow({absl::StrCat(i + 1), TypeName(row.type()),
                  Fixed(row.a_m(), 9), Fixed(row.alpha_rad(), 9),
                  Fixed(row.d_m(), 9), Fixed(row.theta_rad(), 9)});
  }
  return absl::StrCat(table.ToString(),
                      FrameText("world from base", dh.world_from_base()),
                      FrameText("last from tool", dh.last_from_tool()));
}

Json TableJson(const v1::DhTable& dh) {
  Json rows = Json::array();
  for (const v1::DhRow& row : dh.rows()) {
    rows.push_back({{"type", TypeName(row.type())},
                    {"a_m", row.a_m()},
                    {"alpha_rad", row.alpha_rad()},
                    {"d_m", row.d_m()},
                    {"theta_rad", row.theta_rad()}});
  }
  return {{"convention", dh.convention() == v1::DhTable::CONVENTION_STANDARD
                             ? "standard"
                             : "modified"},
          {"rows", rows},
          {"world_from_base", FrameJson(dh.world_from_base())},
          {"last_from_tool", FrameJson(dh.last_from_tool())}};
}

absl::Status RunDh(const DhOptions& options, const GlobalOptions& globals,
                   std::string* output) {
  const absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(
      options.file.path, options.file.unit_m, options.file.skin);
  if (!file.ok()) return file.status();
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const auto skeleton =
      UploadedSkeleton::Create((*service)->connection(), file->message);
  if (!skeleton.ok()) return skeleton.status();
  v1::ComputeDhTableRequest request;
  request.set_skeleton((*skeleton)->name());
  request.set_end_effector_id(options.tip);
  request.set_base_joint_id(options.base);
  request.set_convention(options.convention);
  const auto table = (*service)->connection()->Call(
      &v1::KinematicsService::Stub::ComputeDhTable, request);
  if (!table.ok()) return table.status();
  *output += options.format == Format::kJson ? JsonText(TableJson(*table))
                                             : TableText(*table);
  return absl::OkStatus();
}

}  // namespace

Command AddDhCommand(CLI::App& app) {
  auto options = std::make_shared<DhOptions>();
  CLI::App* dh = app.add_subcommand(
      "dh", "The Denavit-Hartenberg table of a serial chain");
  AddSkeletonFileOptions(*dh, &options->file);
  dh->add_option("--tip", options->tip, "End effector or joint at its end")
      ->required()
      ->option_text("ID");
  dh->add_option("--base", options->base, "Its first joint; default the root")
      ->option_text("ID");
  AddChoice<v1::DhTable::Convention>(
      *dh, "--convention", &options->convention,
      {{"standard", v1::DhTable::CONVENTION_STANDARD},
       {"modified", v1::DhTable::CONVENTION_MODIFIED}},
      "Rz Tz Tx Rx, or Rx Tx Tz Rz; default standard");
  AddFormatOption(*dh, &options->format);
  dh->footer(
      "Example:\n  gelenk dh arm.json --tip flange --convention modified");
  return {dh, [options](const GlobalOptions& globals, std::string* output) {
            return RunDh(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
