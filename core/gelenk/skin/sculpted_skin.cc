#include "gelenk/skin/sculpted_skin.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSide = 4;
constexpr int kSculptedPlanes[] = {2, 4};

// From where the plain volume has a vertex; offsets are smooth, so it takes a
// handful.
constexpr int kMaxInversionSteps = 40;
// Of the link's length: how near a vertex must come to its place.
constexpr double kInversionTolerance = 1e-13;
// Nothing that is sculpted stands off farther, m.
constexpr double kMaxOffsetM = 10;

// Bernstein's cubics and their derivatives. `x` is kept within [0, 1]; beyond,
// the derivatives are 0.
struct Cubics {
  double values[kSide];
  double slopes[kSide];

  explicit Cubics(double x) {
    const double kept = std::clamp(x, 0.0, 1.0);
    const double y = 1 - kept;
    const double inside = kept == x ? 1 : 0;
    const double all[] = {y * y * y, 3 * kept * y * y, 3 * kept * kept * y,
                          kept * kept * kept};
    const double by_x[] = {-3 * y * y, 3 * y * y - 6 * kept * y,
                           6 * kept * y - 3 * kept * kept, 3 * kept * kept};
    for (int k = 0; k < kSide; ++k) {
      values[k] = all[k];
      slopes[k] = inside * by_x[k];
    }
  }
};

// By which a plane's point is moved, and how that changes along s and t.
struct Offset {
  Vector3d value = Vector3d::Zero();
  Vector3d by_s = Vector3d::Zero();
  Vector3d by_t = Vector3d::Zero();
};

Offset OffsetAt(const ControlPlane& plane, absl::Span<const Vector3d> offsets_m,
                const Vector2d& half_extents_m, double s, double t) {
  const Cubics across_s(0.5 * (s / half_extents_m[0] + 1));
  const Cubics across_t(0.5 * (t / half_extents_m[1] + 1));
  Offset sum;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const Vector3d& offset = offsets_m[kSide * i + j];
      sum.value += across_s.values[i] * across_t.values[j] * offset;
      sum.by_s += across_s.slopes[i] * across_t.values[j] * offset;
      sum.by_t += across_s.values[i] * across_t.slopes[j] * offset;
    }
  }
  Matrix3d axes;
  axes << plane.s_axis().cross(plane.t_axis()), plane.s_axis(), plane.t_axis();
  return {axes * sum.value, axes * sum.by_s * (0.5 / half_extents_m[0]),
          axes * sum.by_t * (0.5 / half_extents_m[1])};
}

void CheckPlane(const VolumeRig& rig, absl::Span<const SculptedPlane> planes,
                size_t index, Violations& violations) {
  const SculptedPlane& plane = planes[index];
  const std::string field = absl::StrCat("planes[", index, "]");
  if (rig.FindLink(plane.link_id) < 0) {
    violations.Add(field + ".link_id",
                   absl::StrCat("there is no link \"", plane.link_id, "\""));
  }
  if (plane.plane != 2 && plane.plane != 4) {
    violations.Add(field + ".plane",
                   absl::StrCat("want 2 or 4, got ", plane.plane));
  }
  for (size_t i = 0; i < plane.offsets_m.size(); ++i) {
    // Written so that NaN fails.
    if (plane.offsets_m[i].cwiseAbs().maxCoeff() <= kMaxOffsetM &&
        plane.offsets_m[i].allFinite()) {
      continue;
    }
    violations.Add(absl::StrCat(field, ".offsets_m[", i, "]"),
                   absl::StrCat("want numbers within ", kMaxOffsetM, " m"));
  }
  for (size_t other = 0; other < index; ++other) {
    if (planes[other].link_id == plane.link_id &&
        planes[other].plane == plane.plane) {
      violations.Add(
          field, absl::StrCat("is sculpted by planes[", other, "] already"));
    }
  }
}

}  // namespace

absl::StatusOr<std::shared_ptr<const SculptedSkin>> SculptedSkin::Create(
    std::shared_ptr<const LayeredSkin> skin,
    absl::Span<const SculptedPlane> planes) {
  const VolumeRig& rig = skin->rig();
  // So there are few enough to compare all with all.
  const size_t most = std::size(kSculptedPlanes) * rig.link_count();
  Violations violations;
  if (planes.size() > most) {
    violations.Add(
        "planes", absl::StrCat("want at most ", most, ", got ", planes.size()));
    return violations.ToStatus();
  }
  for (size_t i = 0; i < planes.size(); ++i) {
    CheckPlane(rig, planes, i, violations);
  }
  if (!violations.empty()) return violations.ToStatus();
  std::vector<Sculpture> sculptures;
  for (const SculptedPlane& plane : planes) {
    const int link = rig.FindLink(plane.link_id);
    auto found =
        std::find_if(sculptures.begin(), sculptures.end(),
                     [&](const Sculpture& s) { return s.link == link; });
    if (found == sculptures.end()) {
      Sculpture sculpture;
      sculpture.link = link;
      for (auto& offsets : sculpture.offsets_m) {
        offsets.fill(Vector3d::Zero());
      }
      found = sculptures.insert(found, sculpture);
    }
    found->offsets_m[plane.plane == 2 ? 0 : 1] = plane.offsets_m;
  }
  const std::shared_ptr<SculptedSkin> sculpted(
      new SculptedSkin(std::move(skin), std::move(sculptures)));
  if (absl::Status status = sculpted->BindVertices(); !status.ok()) {
    return status;
  }
  return std::shared_ptr<const SculptedSkin>(sculpted);
}

SculptedSkin::SculptedSkin(std::shared_ptr<const LayeredSkin> skin,
                           std::vector<Sculpture> sculptures)
    : Skin(skin->shared_skeleton(),
           std::vector<int>(skin->slots().begin(), skin->slots().end()),
           skin->block_count(), skin->mesh().triangles, skin->mesh().positions,
           skin->rig().rest_positions()),
      skin_(std::move(skin)),
      sculptures_(std::move(sculptures)) {}

absl::Status SculptedSkin::BindVertices() {
  const VolumeRig& rig = skin_->rig();
  std::vector<int> sculpture_of_link(rig.link_count(), -1);
  for (size_t i = 0; i < sculptures_.size(); ++i) {
    sculpture_of_link[sculptures_[i].link] = static_cast<int>(i);
  }
  const TriangleMesh& mesh = skin_->mesh();
  const std::vector<Vector3d> normals = VertexNormals(mesh);
  for (int v = 0; v < vertex_count(); ++v) {
    const VertexBinding& bound = skin_->binding().vertices[v];
    const int link = rig.volume_link(bound.volume);
    const VolumePart part = rig.volume_part(bound.volume);
    if (sculpture_of_link[link] < 0 ||
        (part != VolumePart::kFirstHalf && part != VolumePart::kSecondHalf)) {
      continue;
    }
    Vertex vertex{.slot = slots()[v],
                  .sculpture = sculpture_of_link[link],
                  .is_first_half = part == VolumePart::kFirstHalf,
                  .volume = bound.volume,
                  .plain_at = bound.at,
                  .at = bound.at,
                  .normal_components = {},
                  .share = 1};
    for (const BlendShare& share : skin_->binding().SharesOf(v)) {
      vertex.share -= share.share;
    }
    // Where the sculpted volume has the place of the plain one, by Newton.
    const Vector3d want = rig.rest().volume(bound.volume).Position(bound.at);
    const double tolerance_m = kInversionTolerance * rig.link(link).length_m;
    VolumePoint point = Evaluate(vertex, rig.rest());
    for (int step = 0; step < kMaxInversionSteps; ++step) {
      const Vector3d missing = want - point.position;
      if (missing.norm() <= tolerance_m) break;
      const Vector3d change = point.Jacobian().partialPivLu().solve(missing);
      vertex.at.u += change[0];
      vertex.at.s += change[1];
      vertex.at.t += change[2];
      point = Evaluate(vertex, rig.rest());
    }
    // Rounding may keep it from the last digit. NaN fails the comparisons.
    if (!((want - point.position).norm() <= 1e3 * tolerance_m &&
          point.Jacobian().determinant() > 0)) {
      return absl::InvalidArgumentError(
          absl::StrCat("planes: the offsets of link \"", rig.link(link).id,
                       "\" turn its volume inside out at vertex ", v));
    }
    vertex.normal_components = point.Jacobian().transpose() * normals[v];
    vertices_.push_back(vertex);
  }
  return absl::OkStatus();
}

VolumePoint SculptedSkin::Evaluate(const Vertex& vertex,
                                   const VolumeFrame& frame) const {
  const Sculpture& sculpture = sculptures_[vertex.sculpture];
  const Vector2d& half_extents_m =
      skin_->rig().link(sculpture.link).half_extents_m;
  const VolumeCoordinates& at = vertex.at;
  VolumePoint point = frame.volume(vertex.volume).Evaluate(at);
  // Of P2 and P4 in this half, with P3's midway between the two.
  const double u = at.u, v = 1 - u;
  const double middle = 0.5 * (vertex.is_first_half ? u * u * u : v * v * v);
  const double middle_slope = 1.5 * (vertex.is_first_half ? u * u : -v * v);
  const double own = vertex.is_first_half ? 3 * u * u * v : 3 * u * v * v;
  const double own_slope =
      vertex.is_first_half ? 6 * u * v - 3 * u * u : 3 * v * v - 6 * u * v;
  for (int k = 0; k < 2; ++k) {
    const bool is_own = (k == 0) == vertex.is_first_half;
    const double weight = middle + (is_own ? own : 0);
    const Offset offset =
        OffsetAt(frame.planes(sculpture.link)[kSculptedPlanes[k]],
                 sculpture.offsets_m[k], half_extents_m, at.s, at.t);
    point.position += weight * offset.value;
    point.along_u += (middle_slope + (is_own ? own_slope : 0)) * offset.value;
    point.along_s += weight * offset.by_s;
    point.along_t += weight * offset.by_t;
  }
  return point;
}

void SculptedSkin::Deform(const ConstVectorView& positions,
                          const RigidTransform& world_from_skeleton,
                          SkinWorkspace& workspace,
                          VertexBlocks& blocks) const {
  skin_->Deform(positions, world_from_skeleton, workspace, blocks);
  ForParts(workspace, static_cast<int>(vertices_.size()),
           kSingleVerticesPerPart, [&](int first, int end) {
             for (int i = first; i < end; ++i) {
               Sculpt(vertices_[i], workspace.frame, blocks);
             }
           });
}

void SculptedSkin::Sculpt(const Vertex& vertex, const VolumeFrame& frame,
                          VertexBlocks& blocks) const {
  const VolumePoint point = Evaluate(vertex, frame);
  const Vector3d moved =
      point.position - frame.volume(vertex.volume).Position(vertex.plain_at);
  const Vector3d normal =
      vertex.share *
          DeformedNormal(point, vertex.normal_components).normalized() +
      (1 - vertex.share) * blocks.normal(vertex.slot).cast<double>();
  blocks.Set(
      vertex.slot,
      blocks.position(vertex.slot) + (vertex.share * moved).cast<float>(),
      normal.normalized().cast<float>());
}

size_t SculptedSkin::ByteSize() const {
  return Skin::ByteSize() + sizeof(*this) + skin_->ByteSize() +
         sculptures_.size() * sizeof(Sculpture) +
         vertices_.size() * sizeof(Vertex);
}

}  // namespace gelenk
