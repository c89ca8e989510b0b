#include "tests/core/import/gltf_oracle.h"

#include "tests/testing/matrix_kinematics_oracle.h"

namespace gelenk::testing {
namespace {

using nlohmann::json;

json ParseGltf(absl::string_view bytes) {
  if (bytes.substr(0, 4) != "glTF") return json::parse(bytes);
  // Its length ends the parser's work, as JSON pads with blanks.
  const auto* length =
      reinterpret_cast<const unsigned char*>(bytes.data()) + 12;
  return json::parse(
      bytes.substr(20, length[0] | length[1] << 8 | length[2] << 16));
}

int ParentOf(const json& nodes, int node) {
  for (size_t i = 0; i < nodes.size(); ++i) {
    for (const json& child : nodes[i].value("children", json::array())) {
      if (child == node) return static_cast<int>(i);
    }
  }
  return -1;
}

Eigen::Matrix4d Motion(const json& node, const Eigen::Matrix3d& turn) {
  Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d rotation = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d scale = Eigen::Matrix4d::Identity();
  rotation.topLeftCorner<3, 3>() = turn;
  if (node.contains("matrix")) {
    for (int i = 0; i < 16; ++i) motion(i % 4, i / 4) = node["matrix"][i];
    return motion * rotation;
  }
  if (node.contains("translation")) {
    for (int i = 0; i < 3; ++i) motion(i, 3) = node["translation"][i];
  }
  if (node.contains("rotation")) {
    const json& q = node["rotation"];
    rotation.topLeftCorner<3, 3>() =
        QuaternionMatrix(q[0], q[1], q[2], q[3]) * turn;
  }
  if (node.contains("scale")) {
    for (int i = 0; i < 3; ++i) scale(i, i) = node["scale"][i];
  }
  return motion * rotation * scale;
}

}  // namespace

GltfOracle::GltfOracle(absl::string_view bytes) : root_(ParseGltf(bytes)) {}

Eigen::Matrix4d GltfOracle::SceneFromNode(
    int node, const std::map<int, Eigen::Matrix3d>& turns) const {
  Eigen::Matrix4d scene_from_node = Eigen::Matrix4d::Identity();
  for (; node >= 0; node = ParentOf(root_["nodes"], node)) {
    const auto turn = turns.find(node);
    scene_from_node = Motion(root_["nodes"][node],
                             turn == turns.end() ? Eigen::Matrix3d::Identity()
                                                 : turn->second) *
                      scene_from_node;
  }
  return scene_from_node;
}

}  // namespace gelenk::testing
