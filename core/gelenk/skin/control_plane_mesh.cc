#include "gelenk/skin/control_plane_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

template <class Vector>
void Append(const Vector& numbers, std::vector<float>& list) {
  for (double number : numbers) list.push_back(static_cast<float>(number));
}

void Append(const VolumeCoordinates& at, std::vector<float>& list) {
  Append(Vector3d(at.u, at.s, at.t), list);
}

VolumeCoordinates CoordinatesAt(const std::vector<float>& list, int index) {
  const float* at = &list[3 * index];
  return {at[0], at[1], at[2]};
}

Vector3d VectorAt(const std::vector<float>& list, int index) {
  return Eigen::Map<const Eigen::Vector3f>(&list[3 * index]).cast<double>();
}

class LayoutCheck {
 public:
  explicit LayoutCheck(const ControlPlaneLayout& layout) : layout_(layout) {}

  absl::Status Run() {
    violations_.AddStatus("", CheckPlaneLinks(layout_.links));
    const size_t count = layout_.vertex_volumes.size();
    const size_t parts = layout_.part_vertices.size();
    Size("coordinates", layout_.coordinates, 3 * count);
    Size("normal_components", layout_.normal_components, 3 * count);
    Size("part_volumes", layout_.part_volumes, parts);
    Size("part_coordinates", layout_.part_coordinates, 3 * parts);
    Size("part_shares", layout_.part_shares, parts);
    Size("part_slopes", layout_.part_slopes, 6 * parts);
    Size("part_share_slopes", layout_.part_share_slopes, 2 * parts);
    Range("vertex_volumes", layout_.vertex_volumes,
          VolumeCountOf(layout_.links));
    Range("part_volumes", layout_.part_volumes, VolumeCountOf(layout_.links));
    Range("part_vertices", layout_.part_vertices, static_cast<int>(count));
    if (!std::is_sorted(layout_.part_vertices.begin(),
                        layout_.part_vertices.end())) {
      violations_.Add("part_vertices", "want them rising");
    } else {
      std::vector<int> shared = layout_.part_vertices;
      shared.erase(std::unique(shared.begin(), shared.end()), shared.end());
      Size("own_slopes", layout_.own_slopes, 6 * shared.size());
    }
    return violations_.ToStatus();
  }

 private:
  template <class Number>
  void Size(const char* field, const std::vector<Number>& list, size_t want) {
    if (list.size() == want) return;
    violations_.Add(field,
                    absl::StrCat("want ", want, " numbers, got ", list.size()));
  }

  void Range(const char* field, const std::vector<int>& list, int end) {
    for (size_t i = 0; i < list.size(); ++i) {
      if (list[i] >= 0 && list[i] < end) continue;
      violations_.Add(absl::StrCat(field, "[", i, "]"),
                      absl::StrCat("want 0 to ", end - 1, ", got ", list[i]));
      return;
    }
  }

  const ControlPlaneLayout& layout_;
  Violations violations_;
};

}  // namespace

ControlPlaneLayout LayoutOf(const LayeredSkin& skin) {
  const VolumeRig& rig = skin.rig();
  const SkinBinding& binding = skin.binding();
  ControlPlaneLayout layout;
  layout.links = PlaneLinksOf(rig);
  const std::vector<Vector3d> normals = VertexNormals(skin.mesh());
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const VertexBinding& vertex = binding.vertices[v];
    layout.vertex_volumes.push_back(vertex.volume);
    Append(vertex.at, layout.coordinates);
    const Eigen::Matrix3d jacobian =
        rig.rest().volume(vertex.volume).Evaluate(vertex.at).Jacobian();
    Append(Vector3d(jacobian.transpose() * normals[v]),
           layout.normal_components);
  }
  for (const LayeredSkin::SharedVertex& shared : skin.shared_vertices()) {
    const auto parts = skin.PartsOf(shared);
    for (const LayeredSkin::VolumeShare& part :
         parts.subspan(0, parts.size() - 1)) {
      layout.part_vertices.push_back(shared.vertex);
      layout.part_volumes.push_back(part.volume);
      Append(part.at, layout.part_coordinates);
      layout.part_shares.push_back(static_cast<float>(part.share));
      for (const Vector3d& slopes : part.coordinate_slopes) {
        Append(slopes, layout.part_slopes);
      }
      Append(part.share_slopes, layout.part_share_slopes);
    }
    for (const Vector3d& slopes : parts.back().coordinate_slopes) {
      Append(slopes, layout.own_slopes);
    }
  }
  return layout;
}

absl::StatusOr<ControlPlaneMesh> ControlPlaneMesh::Create(
    ControlPlaneLayout layout) {
  if (absl::Status status = LayoutCheck(layout).Run(); !status.ok()) {
    return status;
  }
  return ControlPlaneMesh(std::move(layout));
}

absl::Status ControlPlaneMesh::Deform(absl::string_view bytes,
                                      std::vector<Vector3d>& positions,
                                      std::vector<Vector3d>& normals) {
  if (absl::Status status = DecodeControlPlanes(layout_.links, bytes, volumes_);
      !status.ok()) {
    return status;
  }
  positions.resize(vertex_count());
  normals.resize(vertex_count());
  const int part_count = static_cast<int>(layout_.part_vertices.size());
  int part = 0;
  int shared = 0;
  for (int v = 0; v < vertex_count(); ++v) {
    const int first = part;
    while (part < part_count && layout_.part_vertices[part] == v) ++part;
    if (part > first) {
      DeformShared(v, first, part, shared++, positions[v], normals[v]);
      continue;
    }
    const VolumePoint point = volumes_[layout_.vertex_volumes[v]].Evaluate(
        CoordinatesAt(layout_.coordinates, v));
    positions[v] = point.position;
    normals[v] = DeformedNormal(point, VectorAt(layout_.normal_components, v))
                     .normalized();
  }
  return absl::OkStatus();
}

void ControlPlaneMesh::DeformShared(int vertex, int first_part, int end_part,
                                    int shared, Vector3d& position,
                                    Vector3d& normal) const {
  const VolumePoint own = volumes_[layout_.vertex_volumes[vertex]].Evaluate(
      CoordinatesAt(layout_.coordinates, vertex));
  double rest = 1;
  position = own.position;
  Vector3d tangents[2] = {Vector3d::Zero(), Vector3d::Zero()};
  for (int part = first_part; part < end_part; ++part) {
    const VolumePoint point = volumes_[layout_.part_volumes[part]].Evaluate(
        CoordinatesAt(layout_.part_coordinates, part));
    const double share = layout_.part_shares[part];
    const Vector3d way = point.position - own.position;
    rest -= share;
    position += share * way;
    for (int k = 0; k < 2; ++k) {
      tangents[k] += share * (point.Jacobian() *
                              VectorAt(layout_.part_slopes, 2 * part + k)) +
                     double{layout_.part_share_slopes[2 * part + k]} * way;
    }
  }
  for (int k = 0; k < 2; ++k) {
    tangents[k] +=
        rest * (own.Jacobian() * VectorAt(layout_.own_slopes, 2 * shared + k));
  }
  normal = tangents[0].cross(tangents[1]).normalized();
}

}  // namespace gelenk
