#include "gelenk/skin/mesh_around.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kMaxTubeCount = 4096;

// A minimum that rounds the corner where both are alike within `blend`.
double SmoothMinimum(double a, double b, double blend) {
  if (blend <= 0) return std::min(a, b);
  const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
  return std::min(a, b) - 0.25 * h * h * blend;
}

// A field of distances on a grid, and the surface where it is zero.
class SurfaceNet {
 public:
  SurfaceNet(absl::Span<const Capsule> capsules, double cell_m, double blend_m)
      : capsules_(capsules), cell_m_(cell_m), blend_m_(blend_m) {
    Eigen::AlignedBox3d box;
    for (const Capsule& capsule : capsules) {
      for (const auto& [center, radius] :
           {std::pair(capsule.start, capsule.start_radius_m),
            std::pair(capsule.end, capsule.end_radius_m)}) {
        const double reach = radius + blend_m + 2 * cell_m;
        box.extend(center - Vector3d::Constant(reach));
        box.extend(center + Vector3d::Constant(reach));
      }
    }
    origin_ = box.min();
    const Vector3d cells = (box.sizes() / cell_m).array().ceil() + 1;
    cell_count_ = cells.prod();
    if (cell_count_ <= kMaxGridCells) count_ = cells.cast<int>();
  }

  double cell_count() const { return cell_count_; }

  TriangleMesh Mesh() {
    Sample();
    PlaceVertices();
    JoinVertices();
    mesh_.normals.reserve(mesh_.positions.size());
    for (const Vector3d& position : mesh_.positions) {
      mesh_.normals.push_back(GradientAt(position).stableNormalized());
    }
    return std::move(mesh_);
  }

 private:
  int IndexOf(const Vector3i& at) const {
    return (at.z() * count_.y() + at.y()) * count_.x() + at.x();
  }
  Vector3d PointOf(const Vector3i& at) const {
    return origin_ + cell_m_ * at.cast<double>();
  }

  double FieldAt(const Vector3d& point) const {
    double field = DistanceTo(capsules_[0], point);
    for (size_t i = 1; i < capsules_.size(); ++i) {
      field = SmoothMinimum(field, DistanceTo(capsules_[i], point), blend_m_);
    }
    return field;
  }

  Vector3d GradientAt(const Vector3d& point) const {
    const double step = 1e-3 * cell_m_;
    Vector3d gradient;
    for (int k = 0; k < 3; ++k) {
      const Vector3d way = step * Vector3d::Unit(k);
      gradient[k] = FieldAt(point + way) - FieldAt(point - way);
    }
    return gradient;
  }

  template <typename Function>
  void ForEach(const Vector3i& end, const Function& function) const {
    for (int z = 0; z < end.z(); ++z) {
      for (int y = 0; y < end.y(); ++y) {
        for (int x = 0; x < end.x(); ++x) function(Vector3i(x, y, z));
      }
    }
  }

  void Sample() {
    field_.resize(count_.prod());
    ForEach(count_, [&](const Vector3i& at) {
      field_[IndexOf(at)] = FieldAt(PointOf(at));
    });
  }

  bool IsInside(const Vector3i& at) const { return field_[IndexOf(at)] < 0; }

  // One vertex in each cell that the surface goes through: the mean of where
  // it cuts the cell's edges, moved on to the surface.
  void PlaceVertices() {
    vertex_of_.assign(count_.prod(), -1);
    ForEach(count_ - Vector3i::Ones(), [&](const Vector3i& cell) {
      Vector3d sum = Vector3d::Zero();
      int cuts = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Vector3i a =
            cell + Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
        for (int k = 0; k < 3; ++k) {
          if (corner >> k & 1) continue;
          const Vector3i b = a + Vector3i::Unit(k);
          if (IsInside(a) == IsInside(b)) continue;
          const double fa = field_[IndexOf(a)];
          const double fb = field_[IndexOf(b)];
          sum += PointOf(a) + fa / (fa - fb) * (PointOf(b) - PointOf(a));
          ++cuts;
        }
      }
      if (cuts == 0) return;
      Vector3d position = sum / cuts;
      const Vector3d normal = GradientAt(position).stableNormalized();
      position -= FieldAt(position) * normal;
      vertex_of_[IndexOf(cell)] = static_cast<int>(mesh_.positions.size());
      mesh_.positions.push_back(position);
    });
  }

  // A quad around each edge of the grid that the surface cuts.
  void JoinVertices() {
    ForEach(count_ - Vector3i::Ones(), [&](const Vector3i& at) {
      if ((at.array() == 0).any()) return;
      for (int k = 0; k < 3; ++k) {
        const bool inside = IsInside(at);
        if (inside == IsInside(at + Vector3i::Unit(k))) continue;
        const Vector3i i = Vector3i::Unit((k + 1) % 3);
        const Vector3i j = Vector3i::Unit((k + 2) % 3);
        int quad[4] = {vertex_of_[IndexOf(at)], vertex_of_[IndexOf(at - i)],
                       vertex_of_[IndexOf(at - i - j)],
                       vertex_of_[IndexOf(at - j)]};
        if (!inside) std::swap(quad[1], quad[3]);
        mesh_.triangles.push_back({quad[0], quad[1], quad[2]});
        mesh_.triangles.push_back({quad[0], quad[2], quad[3]});
      }
    });
  }

  absl::Span<const Capsule> capsules_;
  double cell_m_;
  double blend_m_;
  Vector3d origin_;
  double cell_count_ = 0;
  Vector3i count_ = Vector3i::Zero();
  std::vector<double> field_;   // at corners of cells
  std::vector<int> vertex_of_;  // of each cell, or -1
  TriangleMesh mesh_;
};

}  // namespace

absl::StatusOr<TriangleMesh> TubeMesh(const TubeShape& shape) {
  Violations violations;
  const auto check = [&](double value, double least, double most,
                         absl::string_view field) {
    if (value >= least && value <= most) return;
    violations.Add(field,
                   absl::StrCat("want ", least, " to ", most, ", got ", value));
  };
  check(shape.length_m, 1e-6, kMaxMeshCoordinateM, "length");
  check(shape.radius_m, 1e-6, kMaxMeshCoordinateM, "radius");
  check(shape.rings, 1, kMaxTubeCount, "rings");
  check(shape.around, 3, kMaxTubeCount, "around");
  if (!violations.empty()) return violations.ToStatus();
  TriangleMesh mesh;
  for (int ring = 0; ring <= shape.rings; ++ring) {
    for (int i = 0; i < shape.around; ++i) {
      const double angle = 2 * std::numbers::pi * i / shape.around;
      mesh.positions.emplace_back(shape.length_m * ring / shape.rings,
                                  shape.radius_m * std::cos(angle),
                                  shape.radius_m * std::sin(angle));
    }
  }
  const int start = static_cast<int>(mesh.positions.size());
  mesh.positions.emplace_back(0, 0, 0);
  mesh.positions.emplace_back(shape.length_m, 0, 0);
  const auto at = [&](int ring, int i) {
    return ring * shape.around + i % shape.around;
  };
  for (int i = 0; i < shape.around; ++i) {
    for (int ring = 0; ring < shape.rings; ++ring) {
      mesh.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i)});
      mesh.triangles.push_back(
          {at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)});
    }
    mesh.triangles.push_back({start, at(0, i + 1), at(0, i)});
    mesh.triangles.push_back(
        {start + 1, at(shape.rings, i), at(shape.rings, i + 1)});
  }
  return mesh;
}

absl::StatusOr<TriangleMesh> MeshAround(absl::Span<const Capsule> capsules,
                                        double cell_m, double blend_m) {
  Violations violations;
  if (capsules.empty()) violations.Add("capsules", "want at least one");
  for (size_t i = 0; i < capsules.size(); ++i) {
    const Capsule& capsule = capsules[i];
    const double most = std::max(
        {capsule.start.cwiseAbs().maxCoeff(), capsule.end.cwiseAbs().maxCoeff(),
         capsule.start_radius_m, capsule.end_radius_m});
    if (capsule.start.allFinite() && capsule.end.allFinite() &&
        most <= kMaxMeshCoordinateM && capsule.start_radius_m > 0 &&
        capsule.end_radius_m > 0) {
      continue;
    }
    violations.Add(absl::StrCat("capsules[", i, "]"),
                   absl::StrCat("want radii > 0 and all within ",
                                kMaxMeshCoordinateM, " m"));
  }
  if (!(cell_m > 0)) {
    violations.Add("cell", absl::StrCat("want > 0 m, got ", cell_m));
  }
  if (!(blend_m >= 0 && blend_m <= kMaxMeshCoordinateM)) {
    violations.Add("blend", absl::StrCat("want >= 0 m, got ", blend_m));
  }
  if (!violations.empty()) return violations.ToStatus();
  SurfaceNet net(capsules, cell_m, blend_m);
  if (!(net.cell_count() <= kMaxGridCells)) {
    violations.Add("cell",
                   absl::StrCat("makes ", net.cell_count(),
                                " cells, want at most ", kMaxGridCells));
    return violations.ToStatus();
  }
  return net.Mesh();
}

double DistanceTo(const Capsule& capsule, const Vector3d& point) {
  const Vector3d axis = capsule.end - capsule.start;
  const double along = std::clamp(
      (point - capsule.start).dot(axis) / std::max(axis.squaredNorm(), 1e-300),
      0.0, 1.0);
  const double radius = capsule.start_radius_m +
                        along * (capsule.end_radius_m - capsule.start_radius_m);
  return (point - capsule.start - along * axis).norm() - radius;
}

}  // namespace gelenk
