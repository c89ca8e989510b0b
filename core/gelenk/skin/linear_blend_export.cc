#include "gelenk/skin/linear_blend_export.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "absl/strings/str_cat.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using Vertex = LinearBlendExport::Vertex;

// Links with a stub, in the order of the stubs.
std::vector<int> BranchesOf(const VolumeRig& rig) {
  std::vector<int> branches;
  for (int i = 0; i < rig.link_count(); ++i) {
    if (rig.is_branch(i)) branches.push_back(i);
  }
  return branches;
}

class Exporter {
 public:
  explicit Exporter(const VolumeRig& rig)
      : rig_(rig),
        branches_(BranchesOf(rig)),
        first_stub_bone_(kPlanesPerLink * rig.link_count()),
        first_link_bone_(first_stub_bone_ +
                         kPlanesPerStub * static_cast<int>(branches_.size())) {}

  std::vector<std::string> BoneNames() const {
    std::vector<std::string> names;
    for (const SkinLink& link : rig_.links()) {
      for (int k = 0; k < kPlanesPerLink; ++k) {
        names.push_back(absl::StrCat(link.id, "/P", k));
      }
    }
    for (int branch : branches_) {
      for (int k = 0; k < kPlanesPerStub; ++k) {
        names.push_back(absl::StrCat(rig_.link(branch).id, "/S", k));
      }
    }
    for (const SkinLink& link : rig_.links()) names.push_back(link.id);
    return names;
  }

  Vertex VertexIn(int volume, const VolumeCoordinates& at) const {
    const int link = rig_.volume_link(volume);
    const VolumePart part = rig_.volume_part(volume);
    Vertex vertex;
    if (part == VolumePart::kRigid) {
      vertex.position = {at.u * rig_.link(link).length_m, at.s, at.t};
      vertex.bones.fill(first_link_bone_ + link);
      vertex.weights = {1, 0, 0, 0};
      return vertex;
    }
    const double u = at.u, v = 1 - at.u;
    vertex.position = {0, at.s, at.t};
    vertex.weights = {v * v * v, 3 * u * v * v, 3 * u * u * v, u * u * u};
    for (int k = 0; k < 4; ++k) vertex.bones[k] = FirstBone(link, part) + k;
    return vertex;
  }

 private:
  int FirstBone(int link, VolumePart part) const {
    if (part == VolumePart::kStub) {
      const auto at =
          std::lower_bound(branches_.begin(), branches_.end(), link);
      return first_stub_bone_ +
             kPlanesPerStub * static_cast<int>(at - branches_.begin());
    }
    return kPlanesPerLink * link + (part == VolumePart::kSecondHalf ? 3 : 0);
  }

  const VolumeRig& rig_;
  std::vector<int> branches_;
  int first_stub_bone_;
  int first_link_bone_;
};

}  // namespace

LinearBlendExport ExportLinearBlend(const LayeredSkin& skin) {
  const Exporter exporter(skin.rig());
  LinearBlendExport out;
  out.bones = exporter.BoneNames();
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const VertexBinding& vertex = skin.binding().vertices[v];
    int volume = vertex.volume;
    VolumeCoordinates at = vertex.at;
    double rest = 1;
    for (const BlendShare& share : skin.binding().SharesOf(v)) {
      rest -= share.share;
    }
    double most = rest;
    for (const BlendShare& share : skin.binding().SharesOf(v)) {
      if (share.share <= most) continue;
      most = share.share;
      volume = share.volume;
      at = share.at;
    }
    if (most < 1) out.inexact.push_back(v);
    out.vertices.push_back(exporter.VertexIn(volume, at));
  }
  return out;
}

std::vector<BoneMatrix> BoneMatrices(const VolumeRig& rig,
                                     const VolumeFrame& frame) {
  std::vector<BoneMatrix> matrices;
  for (const ControlPlane& plane : frame.all_planes()) {
    BoneMatrix& matrix = matrices.emplace_back();
    matrix << plane.s_axis().cross(plane.t_axis()), plane.s_axis(),
        plane.t_axis(), plane.center();
  }
  for (int i = 0; i < rig.link_count(); ++i) {
    BoneMatrix& matrix = matrices.emplace_back();
    matrix << frame.rotation(i), frame.origin(i);
  }
  return matrices;
}

}  // namespace gelenk
