#include "gelenk/import/gltf_mesh.h"

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace gelenk {
namespace {

using Eigen::MatrixXd;
using nlohmann::json;

// glTF 2.0, "mesh.primitive.mode".
enum Mode : size_t { kTriangles = 4, kStrip = 5, kFan = 6, kModes = 7 };

constexpr int kInfluencesPerSet = 4;
constexpr int kSets = 2;

// Extensions that keep a primitive's numbers elsewhere.
constexpr const char* kCompressions[] = {"KHR_draco_mesh_compression",
                                         "EXT_meshopt_compression"};

absl::Status Fault(absl::string_view path, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", reason));
}

class PrimitiveReader {
 public:
  PrimitiveReader(const json& primitive, bool with_influences,
                  const MeshBounds& bounds, GltfAccessors& accessors,
                  GltfMesh& mesh)
      : primitive_(primitive),
        with_influences_(with_influences),
        bounds_(bounds),
        accessors_(accessors),
        mesh_(mesh),
        first_vertex_(mesh.surface.positions.size()),
        first_triangle_(mesh.surface.triangles.size()) {}

  // Appends to the mesh. Paths of errors begin below the primitive.
  absl::Status Append();

 private:
  absl::Status CheckCompression() const;
  absl::Status AppendPositions();
  absl::Status AppendTriangles(size_t mode);
  absl::Status AppendNormals();
  absl::Status AppendInfluences();

  // One column a vertex.
  absl::StatusOr<MatrixXd> ReadAttribute(const std::string& attribute, int rows,
                                         GltfNumbers numbers);
  // Corners of triangles, strip or fan, within this primitive.
  absl::StatusOr<std::vector<int>> ReadIndices();

  const json& primitive_;
  const bool with_influences_;
  const MeshBounds& bounds_;
  GltfAccessors& accessors_;
  GltfMesh& mesh_;
  const size_t first_vertex_;
  const size_t first_triangle_;
  const json* attributes_ = nullptr;
  size_t vertex_count_ = 0;
};

absl::Status PrimitiveReader::Append() {
  if (!primitive_.is_object()) {
    return absl::InvalidArgumentError("want an object");
  }
  const absl::StatusOr<size_t> mode =
      ReadWhole(primitive_, "mode", "primitive", kTriangles);
  if (!mode.ok()) return mode.status();
  if (*mode >= kModes) {
    return Fault("mode", absl::StrFormat("want 0 to 6, got %d", *mode));
  }
  if (*mode < kTriangles) {
    ++mesh_.skipped_primitives;
    return absl::OkStatus();
  }
  const auto attributes = primitive_.find("attributes");
  if (attributes == primitive_.end() || !attributes->is_object()) {
    return Fault("attributes", "want an object");
  }
  attributes_ = &*attributes;
  absl::Status status = CheckCompression();
  if (status.ok()) status = AppendPositions();
  if (status.ok()) status = AppendTriangles(*mode);
  if (status.ok()) status = AppendNormals();
  if (status.ok() && with_influences_) status = AppendInfluences();
  return status;
}

absl::Status PrimitiveReader::CheckCompression() const {
  const auto extensions = primitive_.find("extensions");
  if (extensions == primitive_.end()) return absl::OkStatus();
  for (const char* name : kCompressions) {
    if (extensions->contains(name)) {
      return Fault(absl::StrCat("extensions.", name),
                   "is compressed: write the file without");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<MatrixXd> PrimitiveReader::ReadAttribute(
    const std::string& attribute, int rows, GltfNumbers numbers) {
  const std::string path = absl::StrCat("attributes.", attribute);
  const absl::StatusOr<size_t> accessor =
      ReadWhole(*attributes_, attribute.c_str(), "attributes", std::nullopt);
  if (!accessor.ok()) return accessor.status();
  const absl::StatusOr<size_t> count = accessors_.Count(*accessor);
  if (!count.ok()) return Fault(path, count.status().message());
  if (*count != vertex_count_) {
    return Fault(path, absl::StrFormat("want %d, as many as there are "
                                       "positions, got %d",
                                       vertex_count_, *count));
  }
  absl::StatusOr<MatrixXd> values = accessors_.Read(*accessor, rows, numbers);
  if (!values.ok()) return Fault(path, values.status().message());
  for (Eigen::Index i = 0; i < values->cols(); ++i) {
    if (values->col(i).allFinite()) continue;
    return Fault(absl::StrCat(path, "[", i, "]"),
                 "has a number that is not finite");
  }
  return values;
}

absl::Status PrimitiveReader::AppendPositions() {
  const absl::StatusOr<size_t> accessor =
      ReadWhole(*attributes_, "POSITION", "attributes", std::nullopt);
  if (!accessor.ok()) return accessor.status();
  const absl::StatusOr<size_t> count = accessors_.Count(*accessor);
  if (!count.ok())
    return Fault("attributes.POSITION", count.status().message());
  if (*count > bounds_.max_vertices - first_vertex_) {
    return Fault("attributes.POSITION",
                 absl::StrFormat("want at most %d vertices altogether, got %d",
                                 bounds_.max_vertices, first_vertex_ + *count));
  }
  vertex_count_ = *count;
  const absl::StatusOr<MatrixXd> positions =
      ReadAttribute("POSITION", 3, GltfNumbers::kReal);
  if (!positions.ok()) return positions.status();
  for (Eigen::Index i = 0; i < positions->cols(); ++i) {
    mesh_.surface.positions.emplace_back(positions->col(i));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<int>> PrimitiveReader::ReadIndices() {
  std::vector<int> indices;
  if (!primitive_.contains("indices")) {
    for (size_t i = 0; i < vertex_count_; ++i) {
      indices.push_back(static_cast<int>(i));
    }
    return indices;
  }
  const absl::StatusOr<size_t> accessor =
      ReadWhole(primitive_, "indices", "primitive", std::nullopt);
  if (!accessor.ok()) return accessor.status();
  const absl::StatusOr<size_t> count = accessors_.Count(*accessor);
  if (!count.ok()) return Fault("indices", count.status().message());
  const size_t most = 3 * static_cast<size_t>(bounds_.max_triangles);
  if (*count > most) {
    return Fault("indices",
                 absl::StrFormat("want at most %d, got %d", most, *count));
  }
  const absl::StatusOr<MatrixXd> values =
      accessors_.Read(*accessor, 1, GltfNumbers::kWhole);
  if (!values.ok()) return Fault("indices", values.status().message());
  for (Eigen::Index i = 0; i < values->cols(); ++i) {
    const double index = (*values)(0, i);
    if (index >= static_cast<double>(vertex_count_)) {
      return Fault(absl::StrCat("indices[", i, "]"),
                   absl::StrFormat("want a vertex, 0 to %d, got %.0f",
                                   vertex_count_ - 1, index));
    }
    indices.push_back(static_cast<int>(index));
  }
  return indices;
}

absl::Status PrimitiveReader::AppendTriangles(size_t mode) {
  const absl::StatusOr<std::vector<int>> indices = ReadIndices();
  if (!indices.ok()) return indices.status();
  const size_t count = indices->size();
  if (mode == kTriangles && count % 3 != 0) {
    return Fault("indices",
                 absl::StrFormat("want three for a triangle, got %d", count));
  }
  const size_t triangles =
      mode == kTriangles ? count / 3 : (count < 3 ? 0 : count - 2);
  if (triangles > bounds_.max_triangles - first_triangle_) {
    return Fault(
        "indices",
        absl::StrFormat("want at most %d triangles altogether, got %d",
                        bounds_.max_triangles, first_triangle_ + triangles));
  }
  const auto add = [&](size_t a, size_t b, size_t c) {
    const int first = static_cast<int>(first_vertex_);
    mesh_.surface.triangles.emplace_back(
        first + (*indices)[a], first + (*indices)[b], first + (*indices)[c]);
  };
  for (size_t i = 0; i < triangles; ++i) {
    if (mode == kTriangles) {
      add(3 * i, 3 * i + 1, 3 * i + 2);
    } else if (mode == kFan) {
      add(0, i + 1, i + 2);
    } else if (i % 2 == 0) {
      add(i, i + 1, i + 2);
    } else {
      // Every other triangle of a strip runs the other way round.
      add(i + 1, i, i + 2);
    }
  }
  return absl::OkStatus();
}

absl::Status PrimitiveReader::AppendNormals() {
  std::vector<Eigen::Vector3d>& normals = mesh_.surface.normals;
  normals.resize(first_vertex_ + vertex_count_, Eigen::Vector3d::Zero());
  if (!attributes_->contains("NORMAL")) return absl::OkStatus();
  const absl::StatusOr<MatrixXd> given =
      ReadAttribute("NORMAL", 3, GltfNumbers::kReal);
  if (!given.ok()) return given.status();
  for (size_t i = 0; i < vertex_count_; ++i) {
    normals[first_vertex_ + i] = given->col(static_cast<Eigen::Index>(i));
  }
  return absl::OkStatus();
}

absl::Status PrimitiveReader::AppendInfluences() {
  if (attributes_->contains(absl::StrCat("JOINTS_", kSets))) {
    return Fault(absl::StrCat("attributes.JOINTS_", kSets),
                 absl::StrFormat("want at most %d joints a vertex",
                                 kSets * kInfluencesPerSet));
  }
  std::vector<MatrixXd> joints;
  std::vector<MatrixXd> weights;
  for (int set = 0; set < kSets; ++set) {
    const std::string joints_name = absl::StrCat("JOINTS_", set);
    const std::string weights_name = absl::StrCat("WEIGHTS_", set);
    if (set > 0 && !attributes_->contains(joints_name) &&
        !attributes_->contains(weights_name)) {
      break;
    }
    absl::StatusOr<MatrixXd> set_joints =
        ReadAttribute(joints_name, kInfluencesPerSet, GltfNumbers::kWhole);
    if (!set_joints.ok()) return set_joints.status();
    absl::StatusOr<MatrixXd> set_weights =
        ReadAttribute(weights_name, kInfluencesPerSet, GltfNumbers::kReal);
    if (!set_weights.ok()) return set_weights.status();
    Eigen::Index row = 0;
    Eigen::Index vertex = 0;
    if (set_weights->minCoeff(&row, &vertex) < 0) {
      return Fault(
          absl::StrCat("attributes.", weights_name, "[", vertex, "]"),
          absl::StrFormat("want >= 0, got %g", (*set_weights)(row, vertex)));
    }
    joints.push_back(*std::move(set_joints));
    weights.push_back(*std::move(set_weights));
  }
  for (Eigen::Index i = 0; i < joints[0].cols(); ++i) {
    for (size_t set = 0; set < joints.size(); ++set) {
      for (int k = 0; k < kInfluencesPerSet; ++k) {
        const double weight = weights[set](k, i);
        if (weight == 0) continue;
        mesh_.influences.push_back(
            {static_cast<int>(joints[set](k, i)), weight});
      }
    }
    mesh_.influence_ends.push_back(mesh_.influences.size());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GltfMesh> ReadGltfMesh(const json& root, size_t index,
                                      bool with_influences,
                                      const MeshBounds& bounds,
                                      GltfAccessors& accessors) {
  const absl::StatusOr<const json*> object = ObjectAt(root, "meshes", index);
  if (!object.ok()) return object.status();
  const std::string path = absl::StrCat("meshes[", index, "].primitives");
  const auto primitives = (*object)->find("primitives");
  if (primitives == (*object)->end() || !primitives->is_array() ||
      primitives->empty()) {
    return Fault(path, "want an array of at least one");
  }
  GltfMesh mesh;
  for (size_t i = 0; i < primitives->size(); ++i) {
    PrimitiveReader reader((*primitives)[i], with_influences, bounds, accessors,
                           mesh);
    if (absl::Status status = reader.Append(); !status.ok()) {
      return Fault(absl::StrCat(path, "[", i, "]"), status.message());
    }
  }
  FillMissingNormals(mesh.surface);
  return mesh;
}

}  // namespace gelenk
