#include "gelenk/import/gltf_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/import/glb_container.h"
#include "gelenk/import/gltf_accessor.h"
#include "gelenk/import/gltf_json.h"
#include "gelenk/import/gltf_mesh.h"
#include "gelenk/import/gltf_placement.h"
#include "gelenk/import/joined_mesh.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using Eigen::Affine3d;
using nlohmann::json;

constexpr absl::string_view kKeptAtTop[] = {
    "accessors", "bufferViews", "buffers", "meshes", "nodes", "skins"};
constexpr absl::string_view kKeptBelow[] = {
    "attributes", "buffer",     "bufferView",
    "byteLength", "byteOffset", "byteStride",
    "count",      "extensions", "EXT_meshopt_compression",
    "indices",    "JOINTS_0",   "JOINTS_1",
    "JOINTS_2",   "mesh",       "componentType",
    "mode",       "name",       "KHR_draco_mesh_compression",
    "NORMAL",     "normalized", "inverseBindMatrices",
    "POSITION",   "primitives", "skin",
    "sparse",     "type",       "uri",
    "values",     "WEIGHTS_0",  "WEIGHTS_1"};

// Beyond single precision's rounding the last row of a matrix is no (0 0 0 1).
constexpr double kAffine = 1e-5;

// Numbers that a file's meshes may have together: positions, normals, two sets
// of joints and weights of every vertex, and the corners of the triangles.
constexpr size_t kNumbersPerVertex = 3 + 3 + 4 * 4;

size_t MostNumbers(const MeshBounds& bounds) {
  // Every skin has its matrices, as many as a mesh that fits has numbers.
  return 2 * (kNumbersPerVertex * bounds.max_vertices +
              3 * static_cast<size_t>(bounds.max_triangles));
}

absl::Status Fault(absl::string_view path, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", reason));
}

class SkinnedMeshBuilder {
 public:
  SkinnedMeshBuilder(const json& root, const GltfDocument& document,
                     const GltfImport& import, const GltfSkinOptions& options,
                     GltfAccessors& accessors)
      : root_(root),
        document_(document),
        import_(import),
        options_(options),
        accessors_(accessors),
        placements_(PlaceGltfNodes(document)),
        joined_(*import.skeleton) {}

  absl::StatusOr<GltfSkinnedMesh> Build();

 private:
  // The mesh to take; nothing for all.
  absl::StatusOr<std::optional<size_t>> ChooseMesh() const;
  // Nodes that the scene shows.
  std::vector<bool> ShownNodes() const;

  absl::Status AddNode(size_t node, size_t mesh);
  absl::StatusOr<MeshBinding> BindingOfSkin(size_t skin);
  int JointAbove(size_t node) const;
  Affine3d SkeletonFromNode(size_t node) const;

  std::vector<std::string> Warnings() const;

  const json& root_;
  const GltfDocument& document_;
  const GltfImport& import_;
  const GltfSkinOptions& options_;
  GltfAccessors& accessors_;
  const std::vector<GltfPlacement> placements_;
  JoinedMesh joined_;
  int strangers_ = 0;
  int loose_ = 0;
  int skipped_primitives_ = 0;
};

absl::StatusOr<GltfSkinnedMesh> SkinnedMeshBuilder::Build() {
  const absl::StatusOr<std::optional<size_t>> chosen = ChooseMesh();
  if (!chosen.ok()) return chosen.status();
  const std::vector<bool> is_shown = ShownNodes();
  const auto nodes = root_.find("nodes");
  for (size_t i = 0; i < document_.nodes.size(); ++i) {
    const json& node = (*nodes)[i];
    if (!is_shown[i] || !node.contains("mesh")) continue;
    const std::string path = absl::StrCat("nodes[", i, "]");
    const absl::StatusOr<size_t> mesh =
        ReadWhole(node, "mesh", path, std::nullopt);
    if (!mesh.ok()) return mesh.status();
    if (*chosen && **chosen != *mesh) continue;
    if (absl::Status status = AddNode(i, *mesh); !status.ok()) return status;
  }
  if (joined_.mesh().positions.empty()) {
    return Fault("meshes", "none is moved by this skeleton's joints");
  }
  const absl::Status status = CheckMesh(joined_.mesh(), options_.bounds);
  if (!status.ok()) return status;
  GltfSkinnedMesh result;
  result.weights = joined_.PackedWeights();
  result.joint_from_mesh = joined_.JointFromMesh();
  result.warnings = Warnings();
  result.mesh = joined_.TakeMesh();
  return result;
}

absl::StatusOr<std::optional<size_t>> SkinnedMeshBuilder::ChooseMesh() const {
  if (!options_.mesh) return std::nullopt;
  const auto meshes = root_.find("meshes");
  const size_t count =
      meshes == root_.end() || !meshes->is_array() ? 0 : meshes->size();
  for (size_t i = 0; i < count; ++i) {
    const json& mesh = (*meshes)[i];
    if (mesh.is_object() && mesh.contains("name") &&
        mesh["name"] == *options_.mesh) {
      return i;
    }
  }
  size_t index = 0;
  if (absl::SimpleAtoi(*options_.mesh, &index) && index < count) return index;
  return Fault("mesh", absl::StrFormat("there is none called %s among the %d",
                                       QuotedId(*options_.mesh), count));
}

std::vector<bool> SkinnedMeshBuilder::ShownNodes() const {
  const size_t count = document_.nodes.size();
  if (document_.scene < 0) return std::vector<bool>(count, true);
  std::vector<bool> is_shown(count, false);
  std::vector<int> waiting = document_.scenes[document_.scene].roots;
  while (!waiting.empty()) {
    const int node = waiting.back();
    waiting.pop_back();
    is_shown[node] = true;
    const std::vector<int>& children = document_.nodes[node].children;
    waiting.insert(waiting.end(), children.begin(), children.end());
  }
  return is_shown;
}

absl::Status SkinnedMeshBuilder::AddNode(size_t node, size_t mesh) {
  MeshBinding binding;
  const bool has_skin = document_.nodes[node].has_skin;
  if (has_skin) {
    const absl::StatusOr<size_t> skin =
        ReadWhole(root_["nodes"][node], "skin",
                  absl::StrCat("nodes[", node, "]"), std::nullopt);
    if (!skin.ok()) return skin.status();
    absl::StatusOr<MeshBinding> read = BindingOfSkin(*skin);
    if (!read.ok()) return read.status();
    if (std::count(read->joints.begin(), read->joints.end(), -1) > 0) {
      ++strangers_;
      return absl::OkStatus();
    }
    binding = *std::move(read);
  } else {
    const int joint = JointAbove(node);
    if (joint < 0 || IsFlat(SkeletonFromNode(node))) {
      ++loose_;
      return absl::OkStatus();
    }
    binding.joints = {joint};
    binding.skeleton_from_mesh = {SkeletonFromNode(node)};
    binding.path = absl::StrCat("nodes[", node, "]");
  }
  MeshBounds left = options_.bounds;
  left.max_vertices -= static_cast<int>(joined_.mesh().positions.size());
  left.max_triangles -= static_cast<int>(joined_.mesh().triangles.size());
  absl::StatusOr<GltfMesh> read =
      ReadGltfMesh(root_, mesh, has_skin, left, accessors_);
  if (!read.ok()) return read.status();
  skipped_primitives_ += read->skipped_primitives;
  if (!has_skin) {
    for (size_t i = 0; i < read->surface.positions.size(); ++i) {
      read->influences.push_back({0, 1});
      read->influence_ends.push_back(i + 1);
    }
  }
  return joined_.Append(*read, binding);
}

absl::StatusOr<MeshBinding> SkinnedMeshBuilder::BindingOfSkin(size_t skin) {
  const absl::StatusOr<const json*> object = ObjectAt(root_, "skins", skin);
  if (!object.ok()) return object.status();
  const std::vector<int>& nodes = document_.skins[skin].joints;
  MeshBinding binding;
  binding.path = absl::StrCat("skins[", skin, "]");
  const std::string path = binding.path + ".inverseBindMatrices";
  // Missing, they are identities.
  Eigen::MatrixXd matrices;
  if ((*object)->contains("inverseBindMatrices")) {
    const absl::StatusOr<size_t> accessor =
        ReadWhole(**object, "inverseBindMatrices", binding.path, std::nullopt);
    if (!accessor.ok()) return accessor.status();
    absl::StatusOr<Eigen::MatrixXd> read = accessors_.Read(*accessor, 16);
    if (!read.ok()) return Fault(path, read.status().message());
    if (read->cols() < static_cast<Eigen::Index>(nodes.size())) {
      return Fault(path, absl::StrFormat("want %d, one a joint, got %d",
                                         nodes.size(), read->cols()));
    }
    matrices = *std::move(read);
  }
  for (size_t i = 0; i < nodes.size(); ++i) {
    Affine3d joint_from_bound = Affine3d::Identity();
    if (matrices.size() > 0) {
      const Eigen::Map<const Eigen::Matrix4d> matrix(
          matrices.data() + 16 * static_cast<Eigen::Index>(i));
      const Eigen::RowVector4d last(0, 0, 0, 1);
      // Written so that NaN fails.
      if (!matrix.allFinite() ||
          !((matrix.row(3) - last).cwiseAbs().maxCoeff() <= kAffine)) {
        return Fault(absl::StrCat(path, "[", i, "]"),
                     "want finite numbers and a last row (0, 0, 0, 1)");
      }
      joint_from_bound.matrix().topRows<3>() = matrix.topRows<3>();
    }
    binding.joints.push_back(import_.joint_of_node[nodes[i]]);
    binding.skeleton_from_mesh.push_back(SkeletonFromNode(nodes[i]) *
                                         joint_from_bound);
  }
  return binding;
}

int SkinnedMeshBuilder::JointAbove(size_t node) const {
  for (int i = static_cast<int>(node); i >= 0; i = document_.nodes[i].parent) {
    if (import_.joint_of_node[i] >= 0) return import_.joint_of_node[i];
  }
  return -1;
}

Affine3d SkinnedMeshBuilder::SkeletonFromNode(size_t node) const {
  Affine3d skeleton_from_node;
  skeleton_from_node.linear() = import_.unit_m * placements_[node].linear;
  skeleton_from_node.translation() =
      import_.unit_m * placements_[node].position;
  return skeleton_from_node;
}

std::vector<std::string> SkinnedMeshBuilder::Warnings() const {
  std::vector<std::string> warnings;
  const auto warn = [&](int count, absl::string_view what) {
    if (count > 0) warnings.push_back(absl::StrCat(count, what));
  };
  warn(strangers_, " meshes are left out: their skin has other joints");
  warn(loose_, " meshes are left out: they hang from no joint, or are flat");
  warn(skipped_primitives_, " primitives of points or lines are left out");
  warn(joined_.weightless_vertices(),
       " vertices have no weight: they follow the first joint of their skin");
  return warnings;
}

}  // namespace

absl::StatusOr<GltfSkinnedMesh> ReadGltfSkin(absl::string_view bytes,
                                             const GltfDocument& document,
                                             const GltfImport& import,
                                             const GltfSkinOptions& options,
                                             const OpenUri& open_uri,
                                             const GltfBounds& bounds) {
  const absl::StatusOr<json> root =
      ParseGltfJson(bytes, bounds, {kKeptAtTop, kKeptBelow});
  if (!root.ok()) return root.status();
  GltfAccessors accessors(*root, BinaryOfGltf(bytes), open_uri,
                          MostNumbers(options.bounds));
  return SkinnedMeshBuilder(*root, document, import, options, accessors)
      .Build();
}

WeightedSkin::Options BindOptions(const GltfSkinnedMesh& skinned,
                                  BlendMethod method) {
  WeightedSkin::Options options;
  options.method = method;
  options.joint_from_mesh = skinned.joint_from_mesh;
  return options;
}

}  // namespace gelenk
