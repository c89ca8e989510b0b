#include "tests/testing/matrix_kinematics_oracle.h"

#include <cmath>
#include <cstdlib>

namespace gelenk::testing {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

Matrix3d CrossMatrix(const Vector3d& v) {
  Matrix3d cross;
  cross << 0, -v.z(), v.y(),  //
      v.z(), 0, -v.x(),       //
      -v.y(), v.x(), 0;
  return cross;
}

Matrix4d Translation(const Vector3d& v) {
  Matrix4d m = Matrix4d::Identity();
  m.col(3).head<3>() = v;
  return m;
}

Matrix4d Rotation(const Matrix3d& rotation) {
  Matrix4d m = Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation;
  return m;
}

// The images of X and Y under the shortest rotation from Z to `axis`, which
// must not be -Z.
Matrix3d PlaneBasis(const Vector3d& axis) {
  const Vector3d sine = Vector3d::UnitZ().cross(axis);
  const Matrix3d cross = CrossMatrix(sine);
  return Matrix3d::Identity() + cross + cross * cross / (1 + axis.z());
}

int NumberCount(const Joint& joint) {
  if (joint.mimic) return 0;
  switch (joint.type) {
    case JointType::kFixed:
      return 0;
    case JointType::kRevolute:
    case JointType::kPrismatic:
      return 1;
    case JointType::kPlanar:
      return 3;
    case JointType::kSpherical:
      return 4;
    case JointType::kFree:
      return 7;
  }
  return 0;
}

}  // namespace

Matrix4d MatrixKinematicsOracle::WorldFromJoint(absl::string_view id) const {
  const Joint& joint = FindJoint(id);
  const Matrix4d world_from_parent = joint.parent_id.empty()
                                         ? Matrix4d(Matrix4d::Identity())
                                         : WorldFromJoint(joint.parent_id);
  return world_from_parent * MatrixOf(joint.parent_from_joint) * Motion(joint);
}

Matrix4d MatrixKinematicsOracle::WorldFromEndEffector(
    absl::string_view id) const {
  for (const EndEffector& effector : skeleton_.end_effectors()) {
    if (effector.id != id) continue;
    return WorldFromJoint(effector.joint_id) *
           MatrixOf(effector.joint_from_end_effector);
  }
  return WorldFromJoint(id);
}

const Joint& MatrixKinematicsOracle::FindJoint(absl::string_view id) const {
  for (const Joint& joint : skeleton_.joints()) {
    if (joint.id == id) return joint;
  }
  std::abort();  // A mistake in the test.
}

const double* MatrixKinematicsOracle::NumbersOf(const Joint& joint) const {
  const double* numbers = positions_.data();
  for (const Joint& other : skeleton_.joints()) {
    if (other.id == joint.id) break;
    numbers += NumberCount(other);
  }
  return numbers;
}

double MatrixKinematicsOracle::ScalarOf(const Joint& joint) const {
  if (!joint.mimic) return *NumbersOf(joint);
  const Joint& followed = FindJoint(joint.mimic->joint_id);
  return joint.mimic->multiplier * *NumbersOf(followed) + joint.mimic->offset;
}

Matrix4d MatrixKinematicsOracle::Motion(const Joint& joint) const {
  const double* q = NumbersOf(joint);
  switch (joint.type) {
    case JointType::kFixed:
      return Matrix4d::Identity();
    case JointType::kRevolute:
      return Rotation(AxisAngleMatrix(joint.axis, ScalarOf(joint)));
    case JointType::kPrismatic:
      return Translation(ScalarOf(joint) * joint.axis);
    case JointType::kSpherical:
      return Rotation(QuaternionMatrix(q[0], q[1], q[2], q[3]));
    case JointType::kPlanar:
      return Translation(PlaneBasis(joint.axis) * Vector3d(q[0], q[1], 0)) *
             Rotation(AxisAngleMatrix(joint.axis, q[2]));
    case JointType::kFree:
      return Translation({q[0], q[1], q[2]}) *
             Rotation(QuaternionMatrix(q[3], q[4], q[5], q[6]));
  }
  std::abort();
}

Matrix3d QuaternionMatrix(double x, double y, double z, double w) {
  Matrix3d m;
  m << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return m;
}

Matrix3d AxisAngleMatrix(const Vector3d& axis, double angle_rad) {
  const Matrix3d cross = CrossMatrix(axis);
  return Matrix3d::Identity() + std::sin(angle_rad) * cross +
         (1 - std::cos(angle_rad)) * cross * cross;
}

Matrix4d MatrixOf(const RigidTransform& transform) {
  const Eigen::Quaterniond& q = transform.rotation;
  return Translation(transform.translation) *
         Rotation(QuaternionMatrix(q.x(), q.y(), q.z(), q.w()));
}

double OriginDistance(const Matrix4d& a, const Matrix4d& b) {
  return (a.col(3) - b.col(3)).norm();
}

double AxesAngle(const Matrix4d& a, const Matrix4d& b) {
  const Matrix3d difference =
      a.topLeftCorner<3, 3>().transpose() * b.topLeftCorner<3, 3>();
  const Vector3d twice_sine(difference(2, 1) - difference(1, 2),
                            difference(0, 2) - difference(2, 0),
                            difference(1, 0) - difference(0, 1));
  return std::atan2(twice_sine.norm(), difference.trace() - 1);
}

}  // namespace gelenk::testing
