// Points, rotations and transforms between the contract and the core.
//
// Nothing is checked here: what a client sent is checked where it is used, by
// the functions of the core that know the field's name.
#ifndef GELENK_CONVERT_GEOMETRY_H_
#define GELENK_CONVERT_GEOMETRY_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gelenk/math/rigid_transform.h"
#include "gelenk/v1/geometry.pb.h"

namespace gelenk::convert {

Eigen::Vector3d FromProto(const v1::Vector3& proto);
// All zero, as an unset message reads, is no rotation: the checks refuse it.
Eigen::Quaterniond FromProto(const v1::Quaternion& proto);
// Unset parts are zero and identity.
RigidTransform FromProto(const v1::RigidTransform& proto);

void ToProto(const Eigen::Vector3d& vector, v1::Vector3* proto);
void ToProto(const Eigen::Quaterniond& rotation, v1::Quaternion* proto);
void ToProto(const RigidTransform& transform, v1::RigidTransform* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_GEOMETRY_H_
