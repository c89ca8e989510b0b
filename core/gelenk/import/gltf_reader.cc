#include "gelenk/import/gltf_reader.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/types/span.h"
#include "gelenk/base/violations.h"
#include "gelenk/formats/unique_names.h"
#include "gelenk/import/gltf_json.h"
#include "gelenk/math/rotation.h"
#include "gelenk/retarget/body_role.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using nlohmann::json;

// No length in any unit comes near; keeps squares finite.
constexpr double kMaxMagnitude = 1e9;

// Beyond single precision's rounding the last row of a matrix is no (0 0 0 1).
constexpr double kAffine = 1e-5;

// Members of the objects that are read, and what is in them.
constexpr absl::string_view kKeptAtTop[] = {
    "asset", "nodes", "skins", "scenes", "scene", "animations", "extensions"};
constexpr absl::string_view kKeptBelow[] = {
    "VRM", "VRMC_vrm", "bone", "channels", "children", "humanBones", "humanoid",
    "joints", "matrix", "name", "node", "nodes", "path", "rotation", "scale",
    "skin", "target", "translation", "version",
    // Bones of VRM 1 that have a role.
    "hips", "chest", "upperChest", "neck", "head", "leftShoulder",
    "leftUpperArm", "leftLowerArm", "leftHand", "rightShoulder",
    "rightUpperArm", "rightLowerArm", "rightHand", "leftUpperLeg",
    "leftLowerLeg", "leftFoot", "leftToes", "rightUpperLeg", "rightLowerLeg",
    "rightFoot", "rightToes"};

// A member of an object, and its path for messages.
struct Member {
  const json* value = nullptr;
  std::string path;

  explicit operator bool() const { return value != nullptr; }
};

std::string Index(absl::string_view path, size_t i) {
  return absl::StrCat(path, "[", i, "]");
}

class GltfParser {
 public:
  explicit GltfParser(const json& root) : root_{&root, ""} {}

  absl::StatusOr<GltfDocument> Parse(const GltfBounds& bounds);

 private:
  void ReadVersion();
  void ReadNode(const Member& member, GltfNode& node);
  void ReadMatrix(const Member& matrix, GltfNode& node);
  void ReadSkin(const Member& member, GltfSkin& skin);
  void ReadAnimation(const Member& member);
  void ReadScenes();
  void ReadHumanoid();
  void ReadHumanBone(const std::string& bone, const Member& node);

  // Sets the nodes' parents.
  void ConnectNodes();
  void CheckForest();
  void CheckSceneRoots();

  // Nothing where it is missing.
  Member Find(const Member& object, const char* key) const;
  // Refuses what is there and no array. An array that is not there has none.
  size_t CountElements(const Member& array);
  // Calls `read` with each element of an array.
  template <class Read>
  void ForEach(const Member& array, Read read) {
    for (size_t i = 0; i < CountElements(array); ++i) {
      read(Member{&(*array.value)[i], Index(array.path, i)});
    }
  }
  std::string ReadName(const Member& object);
  // False where it is missing or refused; `numbers` may be changed all the
  // same.
  bool ReadNumbers(const Member& array, absl::Span<double> numbers);
  // Of one of `count` things of a kind; false where it is missing or refused.
  bool ReadIndex(const Member& member, absl::string_view kind, size_t count,
                 int& index);
  // Indices of nodes, each once.
  std::vector<int> ReadNodeIndices(const Member& array);

  void Refuse(const Member& member, absl::string_view reason) {
    violations_.Add(member.path, reason);
  }

  const Member root_;
  Violations violations_;
  GltfDocument document_;
};

Member GltfParser::Find(const Member& object, const char* key) const {
  Member member;
  if (!object || !object.value->is_object()) return member;
  const auto found = object.value->find(key);
  if (found == object.value->end()) return member;
  member.value = &*found;
  member.path = object.path.empty() ? key : absl::StrCat(object.path, ".", key);
  return member;
}

size_t GltfParser::CountElements(const Member& array) {
  if (!array) return 0;
  if (array.value->is_array()) return array.value->size();
  Refuse(array, "want an array");
  return 0;
}

std::string GltfParser::ReadName(const Member& object) {
  if (!object.value->is_object()) {
    Refuse(object, "want an object");
    return "";
  }
  const Member name = Find(object, "name");
  if (!name) return "";
  if (name.value->is_string()) return name.value->get<std::string>();
  Refuse(name, "want a string");
  return "";
}

bool GltfParser::ReadNumbers(const Member& array, absl::Span<double> numbers) {
  if (!array) return false;
  if (!array.value->is_array() || array.value->size() != numbers.size()) {
    Refuse(array, absl::StrCat("want ", numbers.size(), " numbers"));
    return false;
  }
  for (size_t i = 0; i < numbers.size(); ++i) {
    const json& value = (*array.value)[i];
    if (value.is_number()) numbers[i] = value.get<double>();
    if (value.is_number() && std::abs(numbers[i]) <= kMaxMagnitude) continue;
    violations_.Add(Index(array.path, i), "want a number of at most 1e9");
    return false;
  }
  return true;
}

bool GltfParser::ReadIndex(const Member& member, absl::string_view kind,
                           size_t count, int& index) {
  if (!member) return false;
  const json& value = *member.value;
  if (!value.is_number()) {
    Refuse(member, absl::StrFormat("want the index of a %s", kind));
    return false;
  }
  // Some writers have all numbers with a point.
  const double number = value.get<double>();
  if (!(number >= 0 && number < static_cast<double>(count)) ||
      number != std::floor(number)) {
    Refuse(member, count == 0 ? absl::StrFormat("there is no %s", kind)
                              : absl::StrFormat("want a %s, 0 to %d, got %g",
                                                kind, count - 1, number));
    return false;
  }
  index = static_cast<int>(number);
  return true;
}

std::vector<int> GltfParser::ReadNodeIndices(const Member& array) {
  std::vector<int> indices;
  ForEach(array, [&](const Member& element) {
    int index = -1;
    if (ReadIndex(element, "node", document_.nodes.size(), index)) {
      indices.push_back(index);
    }
  });
  std::vector<int> sorted = indices;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) {
    Refuse(array, absl::StrFormat("node %d comes twice", *twice));
  }
  return indices;
}

void GltfParser::ReadVersion() {
  const Member version = Find(Find(root_, "asset"), "version");
  if (!version || !version.value->is_string()) {
    violations_.Add("asset.version", "missing: this is no glTF");
    return;
  }
  const auto& text = version.value->get_ref<const std::string&>();
  if (absl::StartsWith(text, "2.")) return;
  Refuse(version, absl::StrCat("want 2.0, got ", QuotedId(text)));
}

// Three axes, perpendicular or nearly, as rotation and scale.
void SplitLinear(const Eigen::Matrix3d& linear, GltfNode& node) {
  node.scale = linear.colwise().norm();
  if (node.scale.minCoeff() <= 0) {
    // Nothing tells how a flat node is turned.
    node.shear = 1;
    return;
  }
  Eigen::Matrix3d axes =
      linear.array().rowwise() / node.scale.transpose().array();
  for (int i = 0; i < 3; ++i) {
    node.shear =
        std::max(node.shear, std::abs(axes.col(i).dot(axes.col((i + 1) % 3))));
  }
  if (axes.determinant() < 0) {
    axes.col(0) = -axes.col(0);
    node.scale.x() = -node.scale.x();
  }
  node.rotation = Eigen::Quaterniond(axes).normalized();
}

void GltfParser::ReadMatrix(const Member& matrix, GltfNode& node) {
  Eigen::Matrix4d parent_from_node;  // Column by column, as in the file.
  if (!ReadNumbers(matrix, absl::MakeSpan(parent_from_node.data(), 16))) return;
  const Eigen::RowVector4d last(0, 0, 0, 1);
  if ((parent_from_node.row(3) - last).cwiseAbs().maxCoeff() > kAffine) {
    Refuse(matrix, "its last row is not (0, 0, 0, 1)");
    return;
  }
  node.translation = parent_from_node.topRightCorner<3, 1>();
  SplitLinear(parent_from_node.topLeftCorner<3, 3>(), node);
}

void GltfParser::ReadNode(const Member& member, GltfNode& node) {
  node.name = ReadName(member);
  node.has_skin = static_cast<bool>(Find(member, "skin"));
  node.children = ReadNodeIndices(Find(member, "children"));
  const Member matrix = Find(member, "matrix");
  const Member rotation = Find(member, "rotation");
  const Member translation = Find(member, "translation");
  const Member scale = Find(member, "scale");
  if (matrix) {
    if (rotation || translation || scale) {
      Refuse(matrix, "together with translation, rotation or scale");
    }
    ReadMatrix(matrix, node);
    return;
  }
  ReadNumbers(translation, absl::MakeSpan(node.translation.data(), 3));
  ReadNumbers(scale, absl::MakeSpan(node.scale.data(), 3));
  double xyzw[4];
  if (ReadNumbers(rotation, absl::MakeSpan(xyzw))) {
    if (NormalizeNearUnit(xyzw)) {
      node.rotation = QuaternionXyzw(xyzw);
    } else {
      Refuse(rotation,
             absl::StrFormat("want a unit quaternion, got (%g, %g, %g, %g)",
                             xyzw[0], xyzw[1], xyzw[2], xyzw[3]));
    }
  }
  // Two of them are half a turn about the third axis.
  const Eigen::Vector3d signs =
      node.scale.unaryExpr([](double s) { return s < 0 ? -1.0 : 1.0; });
  if (signs.minCoeff() < 0 && signs.prod() > 0) {
    node.rotation =
        node.rotation * Eigen::Quaterniond(Eigen::Matrix3d(signs.asDiagonal()));
    node.scale = node.scale.cwiseAbs();
  }
}

void GltfParser::ReadSkin(const Member& member, GltfSkin& skin) {
  skin.name = ReadName(member);
  const Member joints = Find(member, "joints");
  skin.joints = ReadNodeIndices(joints);
  if (!joints || (joints.value->is_array() && joints.value->empty())) {
    Refuse(member, "no joints");
  }
}

void GltfParser::ReadAnimation(const Member& member) {
  ForEach(Find(member, "channels"), [&](const Member& channel) {
    const Member target = Find(channel, "target");
    const Member path = Find(target, "path");
    // Without a node an extension says what moves.
    int node = -1;
    if (ReadIndex(Find(target, "node"), "node", document_.nodes.size(), node) &&
        path && *path.value == "rotation") {
      document_.nodes[node].is_turned = true;
    }
  });
}

void GltfParser::ReadScenes() {
  ForEach(Find(root_, "scenes"), [this](const Member& member) {
    GltfScene& scene = document_.scenes.emplace_back();
    scene.name = ReadName(member);
    scene.roots = ReadNodeIndices(Find(member, "nodes"));
  });
  if (!document_.scenes.empty()) document_.scene = 0;
  ReadIndex(Find(root_, "scene"), "scene", document_.scenes.size(),
            document_.scene);
}

void GltfParser::ReadHumanBone(const std::string& bone, const Member& node) {
  if (!RoleOfHumanoidBone(bone)) return;
  GltfHumanBone read = {bone, -1};
  if (ReadIndex(node, "node", document_.nodes.size(), read.node)) {
    document_.humanoid.push_back(std::move(read));
  }
}

// VRM 0 has a list of {"bone", "node"}, VRM 1 an object by bones.
void GltfParser::ReadHumanoid() {
  const Member extensions = Find(root_, "extensions");
  const auto bones_of = [&](const char* extension) {
    return Find(Find(Find(extensions, extension), "humanoid"), "humanBones");
  };
  const Member by_name = bones_of("VRMC_vrm");
  if (by_name && by_name.value->is_object()) {
    for (const auto& [bone, value] : by_name.value->items()) {
      const Member member = {&value, absl::StrCat(by_name.path, ".", bone)};
      ReadHumanBone(bone, Find(member, "node"));
    }
    return;
  }
  ForEach(bones_of("VRM"), [&](const Member& member) {
    const Member bone = Find(member, "bone");
    if (!bone || !bone.value->is_string()) return;
    ReadHumanBone(bone.value->get<std::string>(), Find(member, "node"));
  });
}

void GltfParser::ConnectNodes() {
  for (size_t i = 0; i < document_.nodes.size(); ++i) {
    for (int child : document_.nodes[i].children) {
      int& parent = document_.nodes[child].parent;
      if (parent < 0) {
        parent = static_cast<int>(i);
        continue;
      }
      violations_.Add(absl::StrCat(Index("nodes", i), ".children"),
                      absl::StrFormat("node %d is a child of node %d already",
                                      child, parent));
    }
  }
}

// Every node has one parent or none, so what is not reached from a root goes
// round in a circle.
void GltfParser::CheckForest() {
  std::vector<int> reached;
  for (size_t i = 0; i < document_.nodes.size(); ++i) {
    if (document_.nodes[i].parent < 0) reached.push_back(static_cast<int>(i));
  }
  for (size_t i = 0; i < reached.size(); ++i) {
    const std::vector<int>& children = document_.nodes[reached[i]].children;
    reached.insert(reached.end(), children.begin(), children.end());
  }
  if (reached.size() == document_.nodes.size()) return;
  std::vector<bool> is_reached(document_.nodes.size(), false);
  for (int node : reached) is_reached[node] = true;
  const auto first = std::find(is_reached.begin(), is_reached.end(), false);
  violations_.Add(Index("nodes", first - is_reached.begin()),
                  "its own ancestor, or below a node that is");
}

void GltfParser::CheckSceneRoots() {
  for (size_t i = 0; i < document_.scenes.size(); ++i) {
    for (int root : document_.scenes[i].roots) {
      const int parent = document_.nodes[root].parent;
      if (parent < 0) continue;
      violations_.Add(
          absl::StrCat(Index("scenes", i), ".nodes"),
          absl::StrFormat("node %d is no root but a child of node %d", root,
                          parent));
    }
  }
}

absl::StatusOr<GltfDocument> GltfParser::Parse(const GltfBounds& bounds) {
  ReadVersion();
  const Member nodes = Find(root_, "nodes");
  const size_t node_count = CountElements(nodes);
  if (node_count > bounds.max_nodes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "nodes: want at most %d, got %d", bounds.max_nodes, node_count));
  }
  document_.nodes.resize(node_count);
  size_t next = 0;
  ForEach(nodes, [&](const Member& member) {
    ReadNode(member, document_.nodes[next++]);
  });
  ForEach(Find(root_, "skins"), [this](const Member& member) {
    ReadSkin(member, document_.skins.emplace_back());
  });
  ForEach(Find(root_, "animations"),
          [this](const Member& member) { ReadAnimation(member); });
  ReadScenes();
  ReadHumanoid();
  ConnectNodes();
  CheckSceneRoots();
  if (violations_.empty()) CheckForest();
  if (!violations_.empty()) return violations_.ToStatus();
  return std::move(document_);
}

}  // namespace

absl::StatusOr<GltfDocument> ReadGltf(absl::string_view bytes,
                                      const GltfBounds& bounds) {
  const absl::StatusOr<json> root =
      ParseGltfJson(bytes, bounds, {kKeptAtTop, kKeptBelow});
  if (!root.ok()) return root.status();
  return GltfParser(*root).Parse(bounds);
}

}  // namespace gelenk
