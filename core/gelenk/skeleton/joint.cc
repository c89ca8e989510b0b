#include "gelenk/skeleton/joint.h"

#include "gelenk/math/rotation.h"

namespace gelenk {

int PositionCount(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return 0;
    case JointType::kRevolute:
    case JointType::kPrismatic:
      return 1;
    case JointType::kSpherical:
      return 4;
    case JointType::kPlanar:
      return 3;
    case JointType::kFree:
      return 7;
  }
  return 0;
}

int VelocityCount(JointType type) {
  switch (type) {
    case JointType::kSpherical:
      return 3;
    case JointType::kFree:
      return 6;
    default:
      return PositionCount(type);
  }
}

absl::string_view JointTypeName(JointType type) {
  switch (type) {
    case JointType::kFixed:
      return "fixed";
    case JointType::kRevolute:
      return "revolute";
    case JointType::kPrismatic:
      return "prismatic";
    case JointType::kSpherical:
      return "spherical";
    case JointType::kPlanar:
      return "planar";
    case JointType::kFree:
      return "free";
  }
  return "unknown";
}

bool NeedsAxis(JointType type) {
  return type == JointType::kRevolute || type == JointType::kPrismatic ||
         type == JointType::kPlanar;
}

Eigen::Matrix3d PlanarBasis(const Eigen::Vector3d& axis) {
  return ShortestRotation(Eigen::Vector3d::UnitZ(), axis).toRotationMatrix();
}

}  // namespace gelenk
