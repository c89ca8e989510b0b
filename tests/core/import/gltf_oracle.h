// Where the nodes of a glTF file are, straight from its JSON: 4 x 4 matrices up
// the tree, as the format defines them. Slow, and independent of what is
// tested.
#ifndef GELENK_TESTS_CORE_IMPORT_GLTF_ORACLE_H_
#define GELENK_TESTS_CORE_IMPORT_GLTF_ORACLE_H_

#include <Eigen/Core>
#include <map>
#include <nlohmann/json.hpp>

#include "absl/strings/string_view.h"

namespace gelenk::testing {

class GltfOracle {
 public:
  // JSON, or a GLB; without faults.
  explicit GltfOracle(absl::string_view bytes);

  const nlohmann::json& root() const { return root_; }

  // With the nodes turned further: parent_from_node =
  // translation * rotation * turns[node] * scale.
  Eigen::Matrix4d SceneFromNode(
      int node, const std::map<int, Eigen::Matrix3d>& turns = {}) const;

 private:
  nlohmann::json root_;
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_IMPORT_GLTF_ORACLE_H_
