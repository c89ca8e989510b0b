#include "convert/geometry.h"

#include "gelenk/math/rotation.h"

namespace gelenk::convert {

Eigen::Vector3d FromProto(const v1::Vector3& proto) {
  return {proto.x(), proto.y(), proto.z()};
}

Eigen::Quaterniond FromProto(const v1::Quaternion& proto) {
  return QuaternionXyzw(proto.x(), proto.y(), proto.z(), proto.w());
}

RigidTransform FromProto(const v1::RigidTransform& proto) {
  RigidTransform transform;
  transform.translation = FromProto(proto.translation());
  if (proto.has_rotation()) transform.rotation = FromProto(proto.rotation());
  return transform;
}

void ToProto(const Eigen::Vector3d& vector, v1::Vector3* proto) {
  proto->set_x(vector.x());
  proto->set_y(vector.y());
  proto->set_z(vector.z());
}

void ToProto(const Eigen::Quaterniond& rotation, v1::Quaternion* proto) {
  proto->set_x(rotation.x());
  proto->set_y(rotation.y());
  proto->set_z(rotation.z());
  proto->set_w(rotation.w());
}

void ToProto(const RigidTransform& transform, v1::RigidTransform* proto) {
  ToProto(transform.translation, proto->mutable_translation());
  ToProto(transform.rotation, proto->mutable_rotation());
}

}  // namespace gelenk::convert
