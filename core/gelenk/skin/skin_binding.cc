#include "gelenk/skin/skin_binding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/mesh_places.h"
#include "gelenk/skin/vertex_placement.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// A surface looks away from its bone: below this cosine it does not.
constexpr double kFacingCosine = 0.2;
constexpr double kFacingPenalty = 4;
// Sections a vertex may lie beyond that no volume holds, and still be of the
// one chain that is as near: its limb is thicker there than in the mean.
constexpr double kFarReach = 2;
// Another chain that scores worse by this factor is none to doubt for.
constexpr double kClearFactor = 1.5;

class MeshBinder {
 public:
  MeshBinder(const VolumeRig& rig, const TriangleMesh& mesh,
             std::vector<const VertexAssignment*> assigned)
      : rig_(rig),
        mesh_(mesh),
        assigned_(std::move(assigned)),
        placer_(rig),
        places_(FindPlaces(mesh.positions)),
        edges_(FindEdgesOfPlaces(mesh.triangles, places_)) {
    FindNormals();
    ShareAssignments();
  }

  // Binds the first vertex of each place; the others there go with it, or the
  // surface would tear, but where somebody decided otherwise.
  SkinBinding Bind() {
    const int count = static_cast<int>(mesh_.positions.size());
    binding_.vertices.resize(count);
    labels_.assign(count, -1);
    for (int v = 0; v < count; ++v) {
      if (IsFirst(v)) FindCandidates(v);
    }
    Flood();
    for (int v = 0; v < count; ++v) {
      if (IsFirst(v)) Readmit(v);
    }
    for (int v = 0; v < count; ++v) {
      if (IsFirst(v)) {
        Place(v);
      } else if (assigned_[v] == assigned_[places_[v]]) {
        binding_.vertices[v] = binding_.vertices[places_[v]];
      } else {
        FindCandidates(v);
        Place(v);
      }
    }
    return std::move(binding_);
  }

 private:
  bool IsFirst(int v) const { return places_[v] == v; }

  // Of places: the means of their vertices'.
  void FindNormals() {
    normals_ = VertexNormals(mesh_);
    for (size_t v = 0; v < places_.size(); ++v) {
      if (!IsFirst(static_cast<int>(v))) normals_[places_[v]] += normals_[v];
    }
    for (Vector3d& normal : normals_) normal.stableNormalize();
  }

  // What was decided for one vertex holds for those at its place that nothing
  // was decided for: the first of them stands for the place.
  void ShareAssignments() {
    for (size_t v = 0; v < places_.size(); ++v) {
      const VertexAssignment*& first = assigned_[places_[v]];
      if (assigned_[v] != nullptr && first == nullptr) first = assigned_[v];
    }
    for (size_t v = 0; v < places_.size(); ++v) {
      if (assigned_[v] == nullptr) assigned_[v] = assigned_[places_[v]];
    }
  }

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
    FindBestOfChains(v, 1);
    if (best_.empty()) {
      vertex.binding_class = BindingClass::kOutside;
      return;
    }
    if (best_.size() == 1) {
      labels_[v] = rig_.chain(best_[0].link);
      return;
    }
    vertex.binding_class = BindingClass::kAmbiguous;
    vertex.candidate_count = static_cast<int>(best_.size());
    binding_.candidates.insert(binding_.candidates.end(), best_.begin(),
                               best_.end());
  }

  // A vertex that no volume holds, but that the surface gives to the chain that
  // is clearly the nearest, is in no doubt.
  void Readmit(int v) {
    VertexBinding& vertex = binding_.vertices[v];
    if (vertex.binding_class != BindingClass::kOutside) return;
    FindBestOfChains(v, kFarReach);
    if (best_.empty() || rig_.chain(best_[0].link) != labels_[v]) return;
    if (best_.size() > 1 && best_[1].score < kClearFactor * best_[0].score) {
      return;
    }
    vertex.binding_class = BindingClass::kUnique;
  }

  // The best candidate of each chain within so many sections, best first.
  void FindBestOfChains(int v, double reach) {
    placer_.FindNear(mesh_.positions[v], reach, near_);
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
    std::sort(best_.begin(), best_.end(),
              [](const auto& a, const auto& b) { return a.score < b.score; });
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
  std::vector<int> places_;
  MeshEdges edges_;                // of places
  std::vector<Vector3d> normals_;  // of places, at the first vertex of each
  std::vector<int> labels_;        // of each vertex: its chain, or -1
  std::vector<Placement> near_;
  std::vector<BindingCandidate> best_;
  SkinBinding binding_;
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
  const MeshEdges edges =
      FindEdgesOfPlaces(mesh.triangles, FindPlaces(mesh.positions));
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
