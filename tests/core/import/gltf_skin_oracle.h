// Where a glTF file's skinned vertices are, by the format's formula in doubles,
// straight from the JSON and the bytes: for each vertex the sum of
// weight * scene_from_joint * inverse bind matrix * position. Slow, and
// independent of what is tested; takes files without faults only.
#ifndef GELENK_TESTS_CORE_IMPORT_GLTF_SKIN_ORACLE_H_
#define GELENK_TESTS_CORE_IMPORT_GLTF_SKIN_ORACLE_H_

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/import/gltf_import.h"
#include "gelenk/skin/skin.h"
#include "tests/core/import/gltf_oracle.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

class GltfSkinOracle {
 public:
  // `bytes` are a GLB, or JSON with its buffers embedded.
  explicit GltfSkinOracle(const std::string& bytes);

  // Of all meshes that nodes show, in the order of nodes and primitives. Nodes
  // are turned further by `turns`, see GltfOracle.
  std::vector<Eigen::Vector3d> Positions(
      const std::map<int, Eigen::Matrix3d>& turns) const;

 private:
  // One column an element.
  Eigen::MatrixXd Read(const nlohmann::json& accessor_index) const;
  double Number(const char* at, int component_type, bool is_normalized) const;

  GltfOracle nodes_;
  std::vector<std::string> buffers_;
};

// How far the vertices of `blocks` are from `positions` at most, as a part of
// their size; infinite where there are more or fewer.
double LargestError(const std::vector<Eigen::Vector3d>& positions,
                    const Skin& skin, const VertexBlocks& blocks);

// A pose of the skeleton, and the same as turns of the nodes that its joints
// are; each up to `most_rad`.
struct TurnedPose {
  Eigen::VectorXd positions;
  std::map<int, Eigen::Matrix3d> turns;
};
TurnedPose RandomTurns(Random& random, const GltfImport& import,
                       double most_rad);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_IMPORT_GLTF_SKIN_ORACLE_H_
