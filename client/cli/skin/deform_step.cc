#include "client/cli/skin/deform_step.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/file_bytes.h"
#include "client/cli/picture/mesh_picture.h"
#include "client/cli/skin/deformed_frames.h"
#include "client/cli/text/table.h"
#include "convert/geometry.h"

namespace gelenk::cli {
namespace {

// A picture of a clip shows so many of its frames.
constexpr size_t kPanels = 8;

// The poses that are asked for; else the rest pose.
absl::StatusOr<PoseList> PosesFor(const SkinOptions& options,
                                  const v1::Skeleton& skeleton) {
  absl::StatusOr<PoseList> list = PosesOf(options.poses, skeleton);
  if (list.ok() && list->poses.empty()) {
    *list->poses.emplace_back().mutable_pose() = skeleton.rest_pose();
  }
  return list;
}

// Evenly spread, the first and the last among them.
std::set<size_t> DrawnOf(size_t frame_count) {
  std::set<size_t> drawn = {0};
  const size_t count = std::min(kPanels, frame_count);
  for (size_t i = 1; i < count; ++i) {
    drawn.insert(i * (frame_count - 1) / (count - 1));
  }
  return drawn;
}

std::string FramesText(const DeformedFrames& deformed, bool has_volumes) {
  const auto count = static_cast<int64_t>(deformed.folds.size());
  Facts facts;
  facts.Add("frames",
            absl::StrCat(count, ", ", deformed.keyframe_count, " keyframes"));
  facts.Add("bytes a frame", absl::StrCat(deformed.bytes / count, ", at most ",
                                          deformed.most_bytes));
  if (!has_volumes) return facts.ToString();
  facts.Add(
      "frames that fold",
      absl::StrCat(std::count_if(deformed.folds.begin(), deformed.folds.end(),
                                 [](int folds) { return folds > 0; })));
  facts.Add("with clamped muscles", absl::StrCat(deformed.clamp_count));
  if (deformed.links.empty()) return facts.ToString();
  Table table({{"LINK"},
               {"FOLDS", Align::kRight},
               {"WORST", Align::kRight},
               {"IN FRAME", Align::kRight},
               {"CLAMPED", Align::kRight}});
  for (const auto& [id, link] : deformed.links) {
    const bool folds = link.fold_count > 0;
    table.AddRow({id, absl::StrCat(link.fold_count),
                  folds ? Fixed(link.least_jacobian, 2) : "-",
                  folds ? absl::StrCat(link.worst_fold_frame) : "-",
                  absl::StrCat(link.clamp_count)});
  }
  return absl::StrCat(facts.ToString(), "\n", table.ToString());
}

absl::Status DrawFrames(const DeformedFrames& deformed,
                        const std::set<size_t>& drawn,
                        const v1::Skeleton& skeleton, const std::string& title,
                        const std::string& path) {
  std::vector<MeshPanel> panels;
  for (size_t frame : drawn) {
    panels.push_back(
        {absl::StrCat("frame ", frame), deformed.positions.at(frame)});
  }
  MeshView view;
  view.up = convert::FromProto(skeleton.up());
  if (std::abs(view.up.z()) > 0.9)
    view.toward_viewer = -Eigen::Vector3d::UnitY();
  return WriteFile(path,
                   MeshPictureSvg(title, deformed.triangles, panels, view));
}

std::string ObjText(const std::vector<Eigen::Vector3d>& positions,
                    const std::vector<Triangle>& triangles) {
  std::string text;
  for (const Eigen::Vector3d& p : positions) {
    absl::StrAppendFormat(&text, "v %.9g %.9g %.9g\n", p.x(), p.y(), p.z());
  }
  for (const Triangle& t : triangles) {
    absl::StrAppend(&text, "f ", t[0] + 1, " ", t[1] + 1, " ", t[2] + 1, "\n");
  }
  return text;
}

}  // namespace

absl::Status RunDeform(const SkinOptions& options,
                       client::Connection& connection, const ServedSkin& served,
                       std::string* output) {
  const absl::StatusOr<v1::Skeleton> skeleton = served.ReadSkeleton();
  if (!skeleton.ok()) return skeleton.status();
  const absl::StatusOr<PoseList> list = PosesFor(options, *skeleton);
  if (!list.ok()) return list.status();
  const bool draws = !options.picture_path.empty();
  const bool writes = !options.out_path.empty();
  const size_t last = list->poses.size() - 1;
  const std::set<size_t> drawn =
      draws ? DrawnOf(list->poses.size()) : std::set<size_t>();
  std::set<size_t> kept = drawn;
  if (writes) kept.insert(last);
  const absl::StatusOr<DeformedFrames> deformed = DeformSkin(
      connection, served.skin().name(), list->poses, options.encoding, kept);
  if (!deformed.ok()) return deformed.status();
  *output += FramesText(*deformed, served.skin().has_layered_volumes());
  if (draws) {
    const absl::Status status =
        DrawFrames(*deformed, drawn, *skeleton, served.skin().display_name(),
                   options.picture_path);
    if (!status.ok()) return status;
    absl::StrAppend(output, "wrote ", options.picture_path, "\n");
  }
  if (!writes) return absl::OkStatus();
  const absl::Status status =
      WriteFile(options.out_path,
                ObjText(deformed->positions.at(last), deformed->triangles));
  if (status.ok()) absl::StrAppend(output, "wrote ", options.out_path, "\n");
  return status;
}

}  // namespace gelenk::cli
