#include "convert/skin_surface.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

void CheckTriples(absl::string_view field, int size, Violations& violations) {
  if (size % 3 == 0) return;
  violations.Add(field, absl::StrCat("want three numbers each, got ", size));
}

template <class Number>
std::vector<Eigen::Vector3d> Vectors(
    const google::protobuf::RepeatedField<Number>& proto) {
  std::vector<Eigen::Vector3d> vectors(proto.size() / 3);
  for (size_t i = 0; i < vectors.size(); ++i) {
    const Number* at = proto.data() + 3 * i;
    vectors[i] = {at[0], at[1], at[2]};
  }
  return vectors;
}

void CopyVectors(const std::vector<Eigen::Vector3d>& vectors,
                 google::protobuf::RepeatedField<float>* proto) {
  proto->Clear();
  proto->Reserve(static_cast<int>(3 * vectors.size()));
  for (const Eigen::Vector3d& vector : vectors) {
    for (double number : vector) proto->Add(static_cast<float>(number));
  }
}

}  // namespace

absl::StatusOr<TriangleMesh> FromProto(const v1::TriangleMesh& proto,
                                       const MeshBounds& bounds) {
  Violations violations;
  CheckTriples("positions", proto.positions_size(), violations);
  CheckTriples("triangles", proto.triangles_size(), violations);
  CheckTriples("normals", proto.normals_size(), violations);
  if (!violations.empty()) return violations.ToStatus();
  TriangleMesh mesh;
  mesh.positions = Vectors(proto.positions());
  mesh.normals = Vectors(proto.normals());
  mesh.triangles.resize(proto.triangles_size() / 3);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const int* at = proto.triangles().data() + 3 * i;
    mesh.triangles[i] = {at[0], at[1], at[2]};
  }
  if (absl::Status status = CheckMesh(mesh, bounds); !status.ok()) {
    return status;
  }
  return mesh;
}

void ToProto(const TriangleMesh& mesh, v1::TriangleMesh* proto) {
  CopyVectors(mesh.positions, proto->mutable_positions());
  CopyVectors(mesh.normals, proto->mutable_normals());
  proto->clear_triangles();
  for (const Triangle& triangle : mesh.triangles) {
    for (int vertex : triangle) proto->add_triangles(vertex);
  }
}

absl::StatusOr<NurbsSurface> FromProto(const v1::NurbsSurface& proto) {
  Violations violations;
  CheckTriples("points", proto.points_size(), violations);
  if (!violations.empty()) return violations.ToStatus();
  NurbsSurface surface;
  surface.u = {proto.u_degree(),
               {proto.u_knots().begin(), proto.u_knots().end()}};
  surface.v = {proto.v_degree(),
               {proto.v_knots().begin(), proto.v_knots().end()}};
  surface.points = Vectors(proto.points());
  surface.weights.assign(proto.weights().begin(), proto.weights().end());
  if (surface.weights.empty()) surface.weights.assign(surface.points.size(), 1);
  surface.trim_curve_count = proto.trim_curve_count();
  return surface;
}

}  // namespace gelenk::convert
