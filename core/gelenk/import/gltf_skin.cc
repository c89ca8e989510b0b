#include "gelenk/import/gltf_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/import/glb_container.h"
#include "gelenk/import/gltf_accessor.h"
#include "gelenk/import/gltf_json.h"
#include "gelenk/import/gltf_mesh.h"
#include "gelenk/import/gltf_placement.h"
#include "gelenk/kinematics/forward_kinematics.h"
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

// Two bindings of a joint are the same when vertices come out so near, as a
// part of the mesh's size.
constexpr double kSameBinding = 1e-5;

// Below that part of its size a matrix has no inverse worth the name.
constexpr double kFlat = 1e-9;

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

bool IsFlat(const Affine3d& transform) {
  const double size = transform.linear().norm();
  // Written so that NaN is flat.
  return !(std::abs(transform.linear().determinant()) >
           kFlat * size * size * size);
}

WeightedSkin::Affine Rows(const Affine3d& transform) {
  return transform.matrix().topRows<3>();
}

// What moves the vertices of one mesh in the scene: a skin, or the joint that
// the mesh hangs from.
struct Binding {
  // Joints of the skeleton, by their places in the skin's list.
  std::vector<int> joints;
  // While everything rests, in the skeleton's unit; one a joint.
  std::vector<Affine3d> skeleton_from_mesh;
  // Of what is at fault.
  std::string path;
};

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
        rest_from_bound_(import.skeleton->joint_count()) {}

  absl::StatusOr<GltfSkinnedMesh> Build();

 private:
  // The mesh to take; nothing for all.
  absl::StatusOr<std::optional<size_t>> ChooseMesh() const;
  // Nodes that the scene shows.
  std::vector<bool> ShownNodes() const;

  absl::Status AddNode(size_t node, size_t mesh);
  absl::StatusOr<Binding> BindingOfSkin(size_t skin);
  int JointAbove(size_t node) const;
  Affine3d SkeletonFromNode(size_t node) const;

  absl::Status Append(const GltfMesh& mesh, const Binding& binding);
  // Where the vertices of `mesh` are bound, such that joints that other meshes
  // have bound already stay as they are.
  absl::StatusOr<Affine3d> Place(const Binding& binding,
                                 const std::vector<double>& weights) const;
  absl::Status Bind(const Binding& binding, const std::vector<double>& weights,
                    const Affine3d& skeleton_from_mesh, double size_m);
  void PackWeights();
  void Warn();

  const json& root_;
  const GltfDocument& document_;
  const GltfImport& import_;
  const GltfSkinOptions& options_;
  GltfAccessors& accessors_;
  const std::vector<GltfPlacement> placements_;
  // Per joint of the skeleton how it moves bound vertices in the rest pose;
  // nothing for one that no mesh has bound.
  std::vector<std::optional<Affine3d>> rest_from_bound_;
  // By joints of the skeleton, for all vertices so far.
  std::vector<GltfInfluence> influences_;
  std::vector<size_t> influence_ends_;
  int strangers_ = 0;
  int loose_ = 0;
  int skipped_primitives_ = 0;
  int weightless_ = 0;
  GltfSkinnedMesh result_;
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
  if (result_.mesh.positions.empty()) {
    return Fault("meshes", "none is moved by this skeleton's joints");
  }
  PackWeights();
  const absl::Status status = CheckMesh(result_.mesh, options_.bounds);
  if (!status.ok()) return status;
  WorldTransforms rest;
  ForwardKinematics(*import_.skeleton, import_.skeleton->rest_positions(),
                    rest);
  for (size_t i = 0; i < rest.size(); ++i) {
    const RigidTransform inverse = rest[i].Inverse();
    const Affine3d joint_from_skeleton =
        Eigen::Translation3d(inverse.translation) * inverse.rotation;
    result_.joint_from_mesh.push_back(
        Rows(joint_from_skeleton *
             rest_from_bound_[i].value_or(Affine3d::Identity())));
  }
  Warn();
  return std::move(result_);
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
  Binding binding;
  const bool has_skin = document_.nodes[node].has_skin;
  if (has_skin) {
    const absl::StatusOr<size_t> skin =
        ReadWhole(root_["nodes"][node], "skin",
                  absl::StrCat("nodes[", node, "]"), std::nullopt);
    if (!skin.ok()) return skin.status();
    absl::StatusOr<Binding> read = BindingOfSkin(*skin);
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
  left.max_vertices -= static_cast<int>(result_.mesh.positions.size());
  left.max_triangles -= static_cast<int>(result_.mesh.triangles.size());
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
  return Append(*read, binding);
}

absl::StatusOr<Binding> SkinnedMeshBuilder::BindingOfSkin(size_t skin) {
  const absl::StatusOr<const json*> object = ObjectAt(root_, "skins", skin);
  if (!object.ok()) return object.status();
  const std::vector<int>& nodes = document_.skins[skin].joints;
  Binding binding;
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

absl::StatusOr<Affine3d> SkinnedMeshBuilder::Place(
    const Binding& binding, const std::vector<double>& weights) const {
  // The joint with most of the mesh, of those bound already if there are any.
  const auto rank = [&](size_t i) {
    return std::pair(weights[i] > 0 && rest_from_bound_[binding.joints[i]],
                     weights[i]);
  };
  size_t best = 0;
  for (size_t i = 1; i < weights.size(); ++i) {
    if (rank(i) > rank(best)) best = i;
  }
  const Affine3d& moved = binding.skeleton_from_mesh[best];
  if (IsFlat(moved)) {
    return Fault(
        binding.path,
        absl::StrFormat("the matrix of joint %d has no inverse", best));
  }
  const auto& bound = rest_from_bound_[binding.joints[best]];
  return bound ? bound->inverse() * moved : moved;
}

absl::Status SkinnedMeshBuilder::Bind(const Binding& binding,
                                      const std::vector<double>& weights,
                                      const Affine3d& skeleton_from_mesh,
                                      double size_m) {
  const Affine3d mesh_from_skeleton = skeleton_from_mesh.inverse();
  for (size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    const Affine3d moved = binding.skeleton_from_mesh[i] * mesh_from_skeleton;
    if (!moved.matrix().allFinite()) {
      return Fault(binding.path,
                   absl::StrFormat("the matrix of joint %d is too large", i));
    }
    std::optional<Affine3d>& bound = rest_from_bound_[binding.joints[i]];
    if (!bound) {
      bound = moved;
      continue;
    }
    const double apart_m = (moved.linear() - bound->linear()).norm() * size_m +
                           (moved.translation() - bound->translation()).norm();
    if (apart_m > kSameBinding * size_m) {
      return Fault(
          binding.path,
          absl::StrFormat(
              "binds joint %s in another place than a mesh before; "
              "take one of the meshes",
              QuotedId(import_.skeleton->joint(binding.joints[i]).id)));
    }
  }
  return absl::OkStatus();
}

absl::Status SkinnedMeshBuilder::Append(const GltfMesh& mesh,
                                        const Binding& binding) {
  // Of each joint of the binding, over all vertices.
  std::vector<double> weights(binding.joints.size(), 0);
  for (const GltfInfluence& influence : mesh.influences) {
    if (influence.joint >= static_cast<int>(weights.size())) {
      return Fault(
          binding.path,
          absl::StrFormat("want a joint, 0 to %d, of every vertex, got "
                          "%d",
                          weights.size() - 1, influence.joint));
    }
    weights[influence.joint] += influence.weight;
  }
  const absl::StatusOr<Affine3d> place = Place(binding, weights);
  if (!place.ok()) return place.status();
  TriangleMesh& joined = result_.mesh;
  const int first = static_cast<int>(joined.positions.size());
  const bool is_mirrored = place->linear().determinant() < 0;
  double size_m = 0;
  for (const Eigen::Vector3d& position : mesh.surface.positions) {
    joined.positions.push_back(*place * position);
    size_m = std::max(size_m, joined.positions.back().norm());
  }
  // Of normals; a mirror leaves them on their side.
  const Eigen::Matrix3d inverse_transpose =
      place->linear().inverse().transpose();
  for (const Eigen::Vector3d& normal : mesh.surface.normals) {
    joined.normals.push_back((inverse_transpose * normal).stableNormalized());
  }
  for (Triangle triangle : mesh.surface.triangles) {
    if (is_mirrored) std::swap(triangle[1], triangle[2]);
    joined.triangles.emplace_back(triangle.array() + first);
  }
  if (absl::Status status = Bind(binding, weights, *place, size_m);
      !status.ok()) {
    return status;
  }
  size_t next = 0;
  for (size_t end : mesh.influence_ends) {
    if (next == end) {
      ++weightless_;
      influences_.push_back({binding.joints[0], 1});
    }
    for (; next < end; ++next) {
      influences_.push_back({binding.joints[mesh.influences[next].joint],
                             mesh.influences[next].weight});
    }
    influence_ends_.push_back(influences_.size());
  }
  return absl::OkStatus();
}

void SkinnedMeshBuilder::PackWeights() {
  size_t most = 1;
  size_t first = 0;
  for (size_t end : influence_ends_) {
    most = std::max(most, end - first);
    first = end;
  }
  SkinWeights& weights = result_.weights;
  weights.influences_per_vertex = static_cast<int>(most);
  weights.joints.assign(most * influence_ends_.size(), 0);
  weights.weights.assign(most * influence_ends_.size(), 0);
  first = 0;
  for (size_t v = 0; v < influence_ends_.size(); ++v) {
    double sum = 0;
    for (size_t i = first; i < influence_ends_[v]; ++i) {
      sum += influences_[i].weight;
    }
    for (size_t i = first; i < influence_ends_[v]; ++i) {
      weights.joints[most * v + i - first] = influences_[i].joint;
      weights.weights[most * v + i - first] = influences_[i].weight / sum;
    }
    first = influence_ends_[v];
  }
}

void SkinnedMeshBuilder::Warn() {
  const auto warn = [this](int count, absl::string_view what) {
    if (count == 0) return;
    result_.warnings.push_back(absl::StrCat(count, what));
  };
  warn(strangers_, " meshes are left out: their skin has other joints");
  warn(loose_, " meshes are left out: they hang from no joint, or are flat");
  warn(skipped_primitives_, " primitives of points or lines are left out");
  warn(weightless_,
       " vertices have no weight: they follow the first joint of their skin");
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
