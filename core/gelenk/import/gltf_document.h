// What a glTF file says about its nodes, as it says it: a forest, the skins
// that are bound to it, the scenes that show it.
//
// Nodes are known by their index; names may be missing or come twice. Lengths
// are in the file's unit, which the format calls metres.
#ifndef GELENK_IMPORT_GLTF_DOCUMENT_H_
#define GELENK_IMPORT_GLTF_DOCUMENT_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace gelenk {

struct GltfNode {
  // Empty where the file gives none.
  std::string name;
  // -1 for a root.
  int parent = -1;
  std::vector<int> children;
  // parent_from_node = translation * rotation * scale. Two negative scales are
  // half a turn, and part of the rotation; a single one stays.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  // Of a node given as a matrix, how far its axes are from perpendicular: the
  // largest cosine. The rotation is then only near.
  double shear = 0;
  // Shows a mesh that is bound to joints; it is nowhere itself.
  bool has_skin = false;
  // An animation of the file rotates it.
  bool is_turned = false;
};

struct GltfSkin {
  std::string name;
  std::vector<int> joints;
};

struct GltfScene {
  std::string name;
  std::vector<int> roots;
};

// A bone of the humanoid that a VRM file says it is ("leftUpperArm").
struct GltfHumanBone {
  std::string bone;
  int node = -1;
};

struct GltfDocument {
  std::vector<GltfNode> nodes;
  std::vector<GltfSkin> skins;
  std::vector<GltfScene> scenes;
  // The one that is shown; -1 without scenes.
  int scene = -1;
  // Of VRM 0 and 1, bones that have a role (retarget/body_role.h); empty for
  // other files.
  std::vector<GltfHumanBone> humanoid;
};

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_DOCUMENT_H_
