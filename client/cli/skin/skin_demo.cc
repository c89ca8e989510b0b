#include "client/cli/skin/skin_demo.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/file_bytes.h"
#include "client/cli/patient_call.h"
#include "client/cli/picture/mesh_picture.h"
#include "client/cli/skin/deformed_frames.h"
#include "client/cli/skin/exported_skin.h"
#include "client/cli/skin/served_skin.h"
#include "client/cli/text/format.h"
#include "client/cli/text/table.h"
#include "convert/pose.h"
#include "convert/skeleton.h"

namespace gelenk::cli {
namespace {

constexpr char kShape[] = "arm";
constexpr char kElbow[] = "forearm";
constexpr int kBendsDegrees[] = {0, 50, 100, 150};
// The file bends there and back in two seconds.
constexpr int kFilmFrames = 60;
constexpr absl::Duration kFilmFrameTime = absl::Milliseconds(33);

class Bending {
 public:
  explicit Bending(std::shared_ptr<const Skeleton> skeleton)
      : skeleton_(std::move(skeleton)) {}

  v1::SkinPose At(double degrees) const {
    Eigen::VectorXd positions = skeleton_->rest_positions();
    const int elbow = skeleton_->FindJoint(kElbow);
    positions[skeleton_->span(elbow).position_offset] =
        degrees * std::numbers::pi / 180;
    v1::SkinPose pose;
    convert::ToProto(positions, pose.mutable_pose());
    return pose;
  }

  std::vector<v1::SkinPose> Stills() const {
    std::vector<v1::SkinPose> poses;
    for (int degrees : kBendsDegrees) poses.push_back(At(degrees));
    return poses;
  }

  std::vector<v1::SkinPose> Film() const {
    std::vector<v1::SkinPose> poses;
    for (int i = 0; i <= kFilmFrames; ++i) {
      const double phase = 2 * std::numbers::pi * i / kFilmFrames;
      poses.push_back(At(kBendsDegrees[3] * (1 - std::cos(phase)) / 2));
    }
    return poses;
  }

 private:
  std::shared_ptr<const Skeleton> skeleton_;
};

// A revision without muscles.
absl::StatusOr<v1::Skin> Relaxed(client::Connection& connection,
                                 const v1::Skin& skin) {
  v1::UpdateMusclesRequest request;
  request.set_name(skin.name());
  for (const v1::Muscle& muscle : skin.layered_volumes().muscles()) {
    request.add_removed_muscle_ids(muscle.muscle_id());
  }
  return connection.Call(&SkinStub::UpdateMuscles, request, PatientCall());
}

std::string RevisionName(const v1::Skin& skin) {
  return absl::StrCat(skin.name(), "@", skin.revision());
}

void AddPanels(const DeformedFrames& deformed, absl::string_view what,
               std::vector<MeshPanel>& panels, Table& table) {
  const double rest =
      EnclosedVolume(deformed.positions.at(0), deformed.triangles);
  for (const auto& [i, positions] : deformed.positions) {
    const double change =
        EnclosedVolume(positions, deformed.triangles) / rest - 1;
    const std::string volume =
        absl::StrCat(change < 0 ? "" : "+", Fixed(100 * change, 1), " %");
    panels.push_back(
        {absl::StrCat(kBendsDegrees[i], "°, ", what, i > 0 ? ", volume " : "",
                      i > 0 ? volume : ""),
         positions});
    table.AddRow({absl::StrCat(kBendsDegrees[i]), std::string(what), volume,
                  absl::StrCat(deformed.folds[i])});
  }
}

}  // namespace

absl::Status RunSkinDemo(const SkinDemoOptions& options,
                         const std::shared_ptr<client::Connection>& connection,
                         std::string* output) {
  SkinSourceOptions source;
  source.path = kShape;
  source.vertex_count = options.vertex_count;
  const auto served = ServedSkin::Open(connection, source, "", {});
  if (!served.ok()) return served.status();
  const absl::StatusOr<v1::Skeleton> message = (*served)->ReadSkeleton();
  if (!message.ok()) return message.status();
  auto skeleton = convert::FromProto(*message);
  if (!skeleton.ok()) return skeleton.status();
  const Bending bending(*std::move(skeleton));
  const v1::Skin& skin = (*served)->skin();
  const absl::StatusOr<v1::Skin> relaxed = Relaxed(*connection, skin);
  if (!relaxed.ok()) return relaxed.status();

  std::vector<MeshPanel> panels;
  Table table({{"BEND (°)", Align::kRight},
               {"MUSCLES"},
               {"VOLUME", Align::kRight},
               {"FOLDS", Align::kRight}});
  std::vector<Triangle> triangles;
  const std::vector<v1::SkinPose> stills = bending.Stills();
  std::set<size_t> all;
  for (size_t i = 0; i < stills.size(); ++i) all.insert(i);
  for (const v1::Skin* revision : {&skin, &*relaxed}) {
    const absl::StatusOr<DeformedFrames> deformed =
        DeformSkin(*connection, RevisionName(*revision), stills,
                   v1::VERTEX_ENCODING_FLOAT32, all);
    if (!deformed.ok()) return deformed.status();
    AddPanels(*deformed, revision == &skin ? "biceps on" : "off", panels,
              table);
    triangles = deformed->triangles;
  }
  *output += table.ToString();
  if (!options.picture_path.empty()) {
    const absl::Status status =
        WriteFile(options.picture_path,
                  MeshPictureSvg("An arm bends, with its biceps and without",
                                 triangles, panels, {}));
    if (!status.ok()) return status;
    absl::StrAppend(output, "wrote ", options.picture_path, "\n");
  }
  if (options.glb_path.empty()) return absl::OkStatus();
  const absl::StatusOr<ExportedSkin> exported = ExportSkin(
      *connection, RevisionName(skin), bending.Film(), kFilmFrameTime);
  if (!exported.ok()) return exported.status();
  if (absl::Status status = WriteFile(options.glb_path, exported->glb);
      !status.ok()) {
    return status;
  }
  absl::StrAppend(output, "wrote ", options.glb_path, "\n");
  return absl::OkStatus();
}

}  // namespace gelenk::cli
