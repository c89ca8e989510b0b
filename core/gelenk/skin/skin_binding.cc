#include "gelenk/skin/skin_binding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/vertex_placement.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// A surface looks away from its bone: below this cosine it does not.
constexpr double kFacingCosine = 0.2;
constexpr double kFacingPenalty = 4;
// Sections reach a little beyond the surface; wider ones take in the
// neighbours'.
constexpr double kSectionMargin = 1.15;
// Of the surface's distances from a bone: where a limb branches off, what comes
// first is another limb's.
constexpr double kSectionQuantile = 0.9;

class MeshBinder {
 public:
  MeshBinder(const VolumeRig& rig, const TriangleMesh& mesh,
             std::vector<const VertexAssignment*> assigned)
      : rig_(rig),
        mesh_(mesh),
        assigned_(std::move(assigned)),
        placer_(rig),
        normals_(VertexNormals(mesh)),
        edges_(FindEdges(static_cast<int>(mesh.positions.size()),
                         mesh.triangles)) {}

  SkinBinding Bind() {
    const int count = static_cast<int>(mesh_.positions.size());
    binding_.vertices.resize(count);
    labels_.assign(count, -1);
    for (int v = 0; v < count; ++v) FindCandidates(v);
    Flood();
    for (int v = 0; v < count; ++v) Place(v);
    return std::move(binding_);
  }

 private:
  // The class of the vertex, its candidates, and its chain if that is sure.
  void FindCandidates(int v) {
    VertexBinding& vertex = binding_.vertices[v];
    vertex.first_candidate = static_cast<int>(binding_.candidates.size());
    if (assigned_[v] != nullptr) {
      vertex.binding_class = BindingClass::kUser;
      vertex.link = rig_.FindLink(assigned_[v]->link_id);
      labels_[v] = rig_.chain(vertex.link);
      return;
    }
    placer_.FindNear(mesh_.positions[v], 1, near_);
    best_.clear();
    for (const Placement& placement : near_) {
      const double cosine = placement.offset_m.normalized().dot(normals_[v]);
      const BindingCandidate candidate = {
          placement.link,
          placement.radius * (cosine < kFacingCosine ? kFacingPenalty : 1)};
      const auto same = std::find_if(
          best_.begin(), best_.end(), [&](const BindingCandidate& other) {
            return rig_.chain(other.link) == rig_.chain(candidate.link);
          });
      if (same == best_.end()) {
        best_.push_back(candidate);
      } else if (candidate.score < same->score) {
        *same = candidate;
      }
    }
    if (best_.empty()) {
      vertex.binding_class = BindingClass::kOutside;
      return;
    }
    if (best_.size() == 1) {
      labels_[v] = rig_.chain(best_[0].link);
      return;
    }
    vertex.binding_class = BindingClass::kAmbiguous;
    std::sort(best_.begin(), best_.end(),
              [](const auto& a, const auto& b) { return a.score < b.score; });
    vertex.candidate_count = static_cast<int>(best_.size());
    binding_.candidates.insert(binding_.candidates.end(), best_.begin(),
                               best_.end());
  }

  bool CanBeOf(int v, int chain) const {
    if (binding_.vertices[v].binding_class == BindingClass::kOutside) {
      return true;
    }
    for (const BindingCandidate& candidate : binding_.CandidatesOf(v)) {
      if (rig_.chain(candidate.link) == chain) return true;
    }
    return false;
  }

  // Dijkstra from all that is sure.
  void Flood() {
    const int count = static_cast<int>(labels_.size());
    std::vector<double> distances(count,
                                  std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (int v = 0; v < count; ++v) {
      if (labels_[v] < 0) continue;
      distances[v] = 0;
      open.push({0, v});
    }
    while (!open.empty()) {
      const auto [distance, v] = open.top();
      open.pop();
      if (distance > distances[v]) continue;
      for (int other : edges_.of(v)) {
        const double longer =
            distance + (mesh_.positions[other] - mesh_.positions[v]).norm();
        if (longer >= distances[other] || !CanBeOf(other, labels_[v])) {
          continue;
        }
        distances[other] = longer;
        labels_[other] = labels_[v];
        open.push({longer, other});
      }
    }
  }

  void Place(int v) {
    VertexBinding& vertex = binding_.vertices[v];
    const Vector3d& point = mesh_.positions[v];
    Placement placement;
    vertex.first_share = static_cast<int>(binding_.shares.size());
    if (assigned_[v] && assigned_[v]->scope == AssignmentScope::kLink) {
      placement = placer_.InLink(point, vertex.link);
    } else {
      placement = placer_.InChain(
          point, labels_[v] >= 0 ? labels_[v] : LikeliestChain(v));
      placer_.AddShares(point, placement, binding_.shares);
    }
    vertex.link = placement.link;
    vertex.volume = placement.volume;
    vertex.at = placement.at;
    vertex.share_count =
        static_cast<int>(binding_.shares.size()) - vertex.first_share;
    if (vertex.binding_class == BindingClass::kOutside) {
      vertex.outside_m = static_cast<float>(
          std::max(0.0, placer_.DistanceFromBone(point, vertex.link) -
                            rig_.link(vertex.link).half_extents_m.mean()));
    }
    const bool near_branch =
        vertex.share_count > 0 ||
        rig_.volume_part(vertex.volume) == VolumePart::kStub;
    if (near_branch && vertex.binding_class == BindingClass::kUnique) {
      vertex.binding_class = BindingClass::kBlend;
    }
  }

  // Of a vertex that no flood reached.
  int LikeliestChain(int v) const {
    const auto candidates = binding_.CandidatesOf(v);
    return rig_.chain(candidates.empty()
                          ? placer_.NearestLink(mesh_.positions[v])
                          : candidates[0].link);
  }

  const VolumeRig& rig_;
  const TriangleMesh& mesh_;
  std::vector<const VertexAssignment*> assigned_;  // of each vertex, or null
  VertexPlacer placer_;
  std::vector<Vector3d> normals_;
  MeshEdges edges_;
  std::vector<int> labels_;  // of each vertex: its chain, or -1
  std::vector<Placement> near_;
  std::vector<BindingCandidate> best_;
  SkinBinding binding_;
};

// Looks from the bone outwards, in every direction: what comes first is the
// limb's own surface, whatever lies beyond.
// A point of a surface and its unit normal.
struct SurfacePoint {
  Vector3d position;
  Vector3d normal;
};

// Points between the vertices of a coarse mesh are this part of a link apart,
// in the mean: as close as a section is looked at.
constexpr double kSpacingOfLink = 1.0 / 16;
// A triangle is cut into so many parts a side at most, and so many points are
// looked at in all.
constexpr int kMostCuts = 16;
constexpr size_t kMostPoints = size_t{1} << 21;

double SpacingFor(const VolumeRig& rig) {
  double length_m = 0;
  for (const SkinLink& link : rig.links()) length_m += link.length_m;
  return kSpacingOfLink * length_m / rig.link_count();
}

// The vertices, and points inside triangles that are larger than the spacing:
// the limbs of a coarse mesh have vertices at their ends only.
std::vector<SurfacePoint> PointsOf(const TriangleMesh& mesh, double spacing_m) {
  const std::vector<Vector3d> normals = VertexNormals(mesh);
  std::vector<SurfacePoint> points;
  for (size_t v = 0; v < normals.size(); ++v) {
    points.push_back({mesh.positions[v], normals[v]});
  }
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3d& a = mesh.positions[triangle[0]];
    const Vector3d ab = mesh.positions[triangle[1]] - a;
    const Vector3d ac = mesh.positions[triangle[2]] - a;
    const double longest_m = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    if (longest_m <= spacing_m || points.size() >= kMostPoints) continue;
    const int cuts = static_cast<int>(
        std::min<double>(std::ceil(longest_m / spacing_m), kMostCuts));
    const Vector3d normal = ab.cross(ac).normalized();
    for (int i = 0; i <= cuts; ++i) {
      for (int j = 0; i + j <= cuts; ++j) {
        points.push_back({a + (i * ab + j * ac) / cuts, normal});
      }
    }
  }
  return points;
}

class SectionFitter {
 public:
  SectionFitter(const VolumeRig& rig, int link)
      : rotation_(rig.rest().rotation(link)),
        origin_(rig.rest().origin(link)),
        link_(rig.link(link)) {
    nearest_.fill(Eigen::Vector2d::Zero());
    distances_.fill(std::numeric_limits<double>::infinity());
  }

  // The section as it is where there is too little to see.
  Eigen::Vector2d Fit(absl::Span<const SurfacePoint> points) {
    for (const SurfacePoint& point : points) {
      Look(point.position, point.normal);
    }
    std::vector<Eigen::Vector2d> seen;
    for (int bin = 0; bin < kBins; ++bin) {
      if (std::isfinite(distances_[bin])) seen.push_back(nearest_[bin]);
    }
    if (static_cast<int>(seen.size()) < kFewDirections) {
      return link_.half_extents_m;
    }
    // How flat the section is, then how large: limbs taper.
    Eigen::Vector2d shape;
    for (int k = 0; k < 2; ++k) {
      shape[k] = Quantile(
          seen, [k](const Eigen::Vector2d& p) { return std::abs(p[k]); });
    }
    if (!(shape.minCoeff() > 0)) return link_.half_extents_m;
    const double size = Quantile(seen, [&](const Eigen::Vector2d& p) {
      return p.cwiseQuotient(shape).norm();
    });
    return kSectionMargin * size * shape;
  }

 private:
  static constexpr int kSlices = 8;
  static constexpr int kDirections = 16;
  static constexpr int kBins = kSlices * kDirections;
  static constexpr int kFewDirections = kBins / 4;

  template <typename Measure>
  static double Quantile(const std::vector<Eigen::Vector2d>& points,
                         const Measure& measure) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Eigen::Vector2d& point : points) {
      values.push_back(measure(point));
    }
    const auto at =
        values.begin() + static_cast<int>(kSectionQuantile * values.size());
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }

  void Look(const Vector3d& point, const Vector3d& normal) {
    const Vector3d local = rotation_.transpose() * (point - origin_);
    const double along = local.x() / link_.length_m;
    if (!(along >= 0 && along < 1)) return;
    const Eigen::Vector2d across = local.tail<2>();
    const double distance = across.norm();
    const Eigen::Vector2d outwards = (rotation_.transpose() * normal).tail<2>();
    if (outwards.dot(across) < kFacingCosine * distance) return;
    const double turn =
        std::atan2(across[1], across[0]) / (2 * std::numbers::pi) + 0.5;
    const int direction =
        std::min(static_cast<int>(kDirections * turn), kDirections - 1);
    const int bin = kDirections * static_cast<int>(kSlices * along) + direction;
    if (distance >= distances_[bin]) return;
    distances_[bin] = distance;
    nearest_[bin] = across;
  }

  const Eigen::Matrix3d& rotation_;
  const Vector3d& origin_;
  const SkinLink& link_;
  std::array<Eigen::Vector2d, kBins> nearest_;
  std::array<double, kBins> distances_;
};

bool AreNeighbours(const VolumeRig& rig, int a, int b) {
  return a == b || rig.link(a).parent == b || rig.link(b).parent == a;
}

}  // namespace

absl::string_view BindingClassName(BindingClass binding_class) {
  switch (binding_class) {
    case BindingClass::kUnique:
      return "unique";
    case BindingClass::kAmbiguous:
      return "ambiguous";
    case BindingClass::kOutside:
      return "outside";
    case BindingClass::kBlend:
      return "blend";
    case BindingClass::kUser:
      return "user";
  }
  return "unknown";
}

absl::StatusOr<SkinBinding> BindMesh(
    const VolumeRig& rig, const TriangleMesh& mesh,
    absl::Span<const VertexAssignment> assignments) {
  Violations violations;
  violations.AddStatus("mesh", CheckMesh(mesh));
  const int count = static_cast<int>(mesh.positions.size());
  std::vector<const VertexAssignment*> assigned(violations.empty() ? count : 0,
                                                nullptr);
  for (size_t i = 0; i < assignments.size(); ++i) {
    const VertexAssignment& assignment = assignments[i];
    const std::string field = absl::StrCat("assignments[", i, "]");
    if (assignment.vertex < 0 || assignment.vertex >= count) {
      violations.Add(
          field + ".vertex",
          absl::StrCat("want 0 to ", count - 1, ", got ", assignment.vertex));
    }
    if (rig.FindLink(assignment.link_id) < 0) {
      violations.Add(field + ".link_id",
                     absl::StrCat("no link \"", assignment.link_id, "\""));
    }
    if (violations.empty()) assigned[assignment.vertex] = &assignment;
  }
  if (!violations.empty()) return violations.ToStatus();
  SkinBinding binding = MeshBinder(rig, mesh, assigned).Bind();
  for (const VertexAssignment* assignment : assigned) {
    if (assignment) binding.assignments.push_back(*assignment);
  }
  return binding;
}

std::shared_ptr<const VolumeRig> FitSections(const VolumeRig& rig,
                                             const TriangleMesh& mesh) {
  const std::vector<SurfacePoint> points = PointsOf(mesh, SpacingFor(rig));
  std::vector<Eigen::Vector2d> half_extents;
  half_extents.reserve(rig.link_count());
  for (int i = 0; i < rig.link_count(); ++i) {
    half_extents.push_back(SectionFitter(rig, i).Fit(points));
  }
  return rig.WithHalfExtents(half_extents);
}

BindingReport ReportOf(const VolumeRig& rig, const TriangleMesh& mesh,
                       const SkinBinding& binding) {
  BindingReport report;
  report.link_counts.resize(rig.link_count());
  for (const VertexBinding& vertex : binding.vertices) {
    const int k = static_cast<int>(vertex.binding_class);
    ++report.class_counts[k];
    ++report.link_counts[vertex.link][k];
  }
  const int count = static_cast<int>(binding.vertices.size());
  const MeshEdges edges = FindEdges(count, mesh.triangles);
  for (int v = 0; v < count; ++v) {
    for (int other : edges.of(v)) {
      const int a = binding.vertices[v].link;
      const int b = binding.vertices[other].link;
      if (other <= v || AreNeighbours(rig, a, b)) continue;
      ++report.stretched_edge_count;
      if (report.stretched_edges.size() < kMaxListedEdges) {
        report.stretched_edges.push_back({{v, other}, {a, b}});
      }
    }
  }
  return report;
}

std::vector<int> VerticesOf(const SkinBinding& binding,
                            BindingClass binding_class) {
  std::vector<int> vertices;
  for (size_t v = 0; v < binding.vertices.size(); ++v) {
    if (binding.vertices[v].binding_class == binding_class) {
      vertices.push_back(static_cast<int>(v));
    }
  }
  return vertices;
}

}  // namespace gelenk
