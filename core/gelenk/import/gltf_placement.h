// Where the nodes of a glTF file are while everything rests.
#ifndef GELENK_IMPORT_GLTF_PLACEMENT_H_
#define GELENK_IMPORT_GLTF_PLACEMENT_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "gelenk/import/gltf_document.h"

namespace gelenk {

// A node in the scene, lengths in the file's unit:
// scene_point = linear * node_point + position.
struct GltfPlacement {
  // Scale and all.
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  // Without the scale.
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

// One a node. Cost: linear.
std::vector<GltfPlacement> PlaceGltfNodes(const GltfDocument& document);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_PLACEMENT_H_
