#include "gelenk/skin/rebind.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/mesh_places.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// A ray that runs along a triangle does not meet it.
constexpr double kGrazing = 1e-12;

class Selection {
 public:
  explicit Selection(const TriangleMesh& mesh) : mesh_(mesh) {}

  absl::StatusOr<std::vector<int>> Run(const VertexSelector& selector) {
    std::visit([this](const auto& s) { Select(s); }, selector);
    if (absl::Status status = violations_.ToStatus(); !status.ok()) {
      return status;
    }
    std::sort(selected_.begin(), selected_.end());
    selected_.erase(std::unique(selected_.begin(), selected_.end()),
                    selected_.end());
    return std::move(selected_);
  }

 private:
  int vertex_count() const { return static_cast<int>(mesh_.positions.size()); }

  void CheckVertex(int vertex, const std::string& field) {
    if (vertex >= 0 && vertex < vertex_count()) return;
    violations_.Add(field, absl::StrCat("want 0 to ", vertex_count() - 1,
                                        ", got ", vertex));
  }
  void CheckFinite(const Vector3d& v, absl::string_view field) {
    if (!v.allFinite()) violations_.Add(field, "want finite numbers");
  }
  void CheckRadius(double radius_m, absl::string_view field) {
    if (!(radius_m >= 0 && std::isfinite(radius_m))) {
      violations_.Add(field, absl::StrCat("want >= 0 m, got ", radius_m));
    }
  }

  template <typename Predicate>
  void SelectWhere(const Predicate& holds) {
    for (int v = 0; v < vertex_count(); ++v) {
      if (holds(mesh_.positions[v])) selected_.push_back(v);
    }
  }

  void Select(const SelectIds& ids) {
    for (size_t i = 0; i < ids.vertices.size(); ++i) {
      CheckVertex(ids.vertices[i], absl::StrCat("ids.vertices[", i, "]"));
    }
    selected_ = ids.vertices;
  }

  void Select(const SelectSphere& sphere) {
    CheckFinite(sphere.center, "sphere.center");
    CheckRadius(sphere.radius_m, "sphere.radius_m");
    SelectWhere([&](const Vector3d& p) {
      return (p - sphere.center).norm() <= sphere.radius_m;
    });
  }

  void Select(const SelectBox& box) {
    CheckFinite(box.lowest, "box.lowest");
    CheckFinite(box.highest, "box.highest");
    if ((box.lowest.array() > box.highest.array()).any()) {
      violations_.Add(
          "box.highest",
          absl::StrCat("want nothing below box.lowest, got ", box.highest.x(),
                       " ", box.highest.y(), " ", box.highest.z()));
    }
    const Eigen::AlignedBox3d bounds(box.lowest, box.highest);
    SelectWhere([&](const Vector3d& p) { return bounds.contains(p); });
  }

  void Select(const SelectComponent& component) {
    CheckVertex(component.vertex, "component_vertex");
    if (!violations_.empty()) return;
    const std::vector<int> components =
        FindComponentsOfPlaces(mesh_.triangles, FindPlaces(mesh_.positions));
    for (int v = 0; v < vertex_count(); ++v) {
      if (components[v] == components[component.vertex]) {
        selected_.push_back(v);
      }
    }
  }

  void Select(const SelectRay& ray) {
    CheckFinite(ray.origin, "ray.origin");
    CheckFinite(ray.direction, "ray.direction");
    if (ray.direction.isZero()) violations_.Add("ray.direction", "is zero");
    CheckRadius(ray.geodesic_radius_m, "ray.geodesic_radius_m");
    if (!violations_.empty()) return;
    Vector3d hit;
    const int triangle = FirstHit(ray, &hit);
    if (triangle >= 0) SelectAround(triangle, hit, ray.geodesic_radius_m);
  }

  // The triangle that the ray meets first, -1 for none.
  int FirstHit(const SelectRay& ray, Vector3d* hit) const {
    const Vector3d direction = ray.direction.normalized();
    int best = -1;
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Triangle& triangle = mesh_.triangles[i];
      const Vector3d& a = mesh_.positions[triangle[0]];
      const Vector3d ab = mesh_.positions[triangle[1]] - a;
      const Vector3d ac = mesh_.positions[triangle[2]] - a;
      const Vector3d p = direction.cross(ac);
      const double det = ab.dot(p);
      if (std::abs(det) <= kGrazing * ab.norm() * ac.norm()) continue;
      const Vector3d offset = ray.origin - a;
      const double x = offset.dot(p) / det;
      const Vector3d q = offset.cross(ab);
      const double y = direction.dot(q) / det;
      const double distance = ac.dot(q) / det;
      if (x < 0 || y < 0 || x + y > 1 || distance < 0) continue;
      if (distance >= nearest) continue;
      nearest = distance;
      best = static_cast<int>(i);
    }
    if (best >= 0) *hit = ray.origin + nearest * direction;
    return best;
  }

  // The corner nearest to the point, and all within the radius along edges.
  void SelectAround(int triangle, const Vector3d& point, double radius_m) {
    const std::vector<int> places = FindPlaces(mesh_.positions);
    const MeshEdges edges = FindEdgesOfPlaces(mesh_.triangles, places);
    std::vector<bool> is_selected(vertex_count(), false);
    std::vector<double> distances(vertex_count(),
                                  std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    Entry nearest = {std::numeric_limits<double>::infinity(), -1};
    for (int vertex : mesh_.triangles[triangle]) {
      const int corner = places[vertex];
      const double distance = (mesh_.positions[corner] - point).norm();
      nearest = std::min(nearest, {distance, corner});
      distances[corner] = distance;
      open.push({distance, corner});
    }
    is_selected[nearest.second] = true;
    while (!open.empty()) {
      const auto [distance, v] = open.top();
      open.pop();
      if (distance > distances[v]) continue;
      if (distance > radius_m) break;
      is_selected[v] = true;
      for (int other : edges.of(v)) {
        const double longer =
            distance + (mesh_.positions[other] - mesh_.positions[v]).norm();
        if (longer >= distances[other]) continue;
        distances[other] = longer;
        open.push({longer, other});
      }
    }
    for (int v = 0; v < vertex_count(); ++v) {
      if (is_selected[places[v]]) selected_.push_back(v);
    }
  }

  const TriangleMesh& mesh_;
  Violations violations_;
  std::vector<int> selected_;
};

}  // namespace

absl::StatusOr<std::vector<int>> SelectVertices(
    const TriangleMesh& mesh, const VertexSelector& selector) {
  return Selection(mesh).Run(selector);
}

absl::StatusOr<RebindResult> Rebind(const VolumeRig& rig,
                                    const TriangleMesh& mesh,
                                    const SkinBinding& binding,
                                    const VertexSelector& selector,
                                    const std::string& link_id,
                                    AssignmentScope scope) {
  if (!link_id.empty() && rig.FindLink(link_id) < 0) {
    Violations violations;
    violations.Add("link_id", absl::StrCat("no link \"", link_id, "\""));
    return violations.ToStatus();
  }
  absl::StatusOr<std::vector<int>> selected = SelectVertices(mesh, selector);
  if (!selected.ok()) return selected.status();
  std::vector<VertexAssignment> assignments;
  for (const VertexAssignment& assignment : binding.assignments) {
    if (!std::binary_search(selected->begin(), selected->end(),
                            assignment.vertex)) {
      assignments.push_back(assignment);
    }
  }
  if (!link_id.empty()) {
    for (int v : *selected) assignments.push_back({v, link_id, scope});
  }
  absl::StatusOr<SkinBinding> bound = BindMesh(rig, mesh, assignments);
  if (!bound.ok()) return bound.status();
  RebindResult result{*std::move(bound), *std::move(selected), {}};
  for (int v : result.selected) {
    if (result.binding.vertices[v].link != binding.vertices[v].link) {
      result.moved.push_back(v);
    }
  }
  return result;
}

BindingHistory::BindingHistory(SkinBinding first) {
  revisions_.push_back(std::make_shared<const SkinBinding>(std::move(first)));
}

absl::StatusOr<std::shared_ptr<const SkinBinding>> BindingHistory::At(
    int revision) const {
  if (revision < 1 || revision > revision_count()) {
    return absl::NotFoundError(absl::StrCat(
        "revision: want 1 to ", revision_count(), ", got ", revision));
  }
  return revisions_[revision - 1];
}

absl::Status BindingHistory::Add(SkinBinding binding) {
  if (current_ + 1 >= kMaxBindingRevisions) {
    return absl::ResourceExhaustedError(
        absl::StrCat("at most ", kMaxBindingRevisions, " revisions"));
  }
  revisions_.resize(current_ + 1);
  revisions_.push_back(std::make_shared<const SkinBinding>(std::move(binding)));
  ++current_;
  return absl::OkStatus();
}

absl::Status BindingHistory::Undo() {
  if (current_ == 0) {
    return absl::FailedPreconditionError("this is the first revision");
  }
  --current_;
  return absl::OkStatus();
}

absl::Status BindingHistory::Redo() {
  if (current_ + 1 == revision_count()) {
    return absl::FailedPreconditionError("this is the last revision");
  }
  ++current_;
  return absl::OkStatus();
}

}  // namespace gelenk
