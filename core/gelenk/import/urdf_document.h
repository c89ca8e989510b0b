// What a URDF says, as it says it: links and the joints between them, by name.
//
// Units m, rad, kg. Every part is sound on its own; whether they make a tree is
// for urdf_import.h to see. Lines count from 1.
#ifndef GELENK_IMPORT_URDF_DOCUMENT_H_
#define GELENK_IMPORT_URDF_DOCUMENT_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/joint.h"

namespace gelenk {

struct UrdfLink {
  std::string name;
  int line = 0;
  double mass_kg = 0;
  // Link frame.
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();
};

// A link or joint by its name, and the line that names it.
struct UrdfReference {
  std::string name;
  int line = 0;
};

struct UrdfMimic {
  UrdfReference joint;
  double multiplier = 1;
  double offset = 0;  // rad or m
};

struct UrdfJoint {
  std::string name;
  int line = 0;
  // `continuous` is revolute, `floating` is free.
  JointType type = JointType::kFixed;
  UrdfReference parent_link;
  // Its frame is the joint's.
  UrdfReference child_link;
  RigidTransform parent_from_joint;
  // Unit; as the file has it only where the type needs one.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  JointLimits limits;
  std::optional<UrdfMimic> mimic;
};

struct UrdfDocument {
  // The robot's.
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  // What the reader took with a grain of salt.
  std::vector<std::string> warnings;
};

}  // namespace gelenk

#endif  // GELENK_IMPORT_URDF_DOCUMENT_H_
