// Forward kinematics once more, slowly and differently: 4 x 4 matrices,
// recursion along parent ids, rotations from their textbook matrix formulas.
// It shares no formula with the library, so that both can only be wrong
// together by being wrong twice.
#ifndef GELENK_TESTS_TESTING_MATRIX_KINEMATICS_ORACLE_H_
#define GELENK_TESTS_TESTING_MATRIX_KINEMATICS_ORACLE_H_

#include <Eigen/Core>
#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

class MatrixKinematicsOracle {
 public:
  // Both must outlive the oracle. `positions` in the skeleton's order.
  MatrixKinematicsOracle(const Skeleton& skeleton,
                         const Eigen::VectorXd& positions)
      : skeleton_(skeleton), positions_(positions) {}

  // Joint or end effector by its id; the id must be known. Cost: quadratic.
  Eigen::Matrix4d WorldFromJoint(absl::string_view id) const;
  Eigen::Matrix4d WorldFromEndEffector(absl::string_view id) const;

 private:
  const Joint& FindJoint(absl::string_view id) const;
  // First number of `joint` in q, by counting.
  const double* NumbersOf(const Joint& joint) const;
  double ScalarOf(const Joint& joint) const;
  Eigen::Matrix4d Motion(const Joint& joint) const;

  const Skeleton& skeleton_;
  const Eigen::VectorXd& positions_;
};

// The rotation matrix of a unit quaternion x y z w, and of an angle about a
// unit axis (Rodrigues).
Eigen::Matrix3d QuaternionMatrix(double x, double y, double z, double w);
Eigen::Matrix3d AxisAngleMatrix(const Eigen::Vector3d& axis, double angle_rad);

Eigen::Matrix4d MatrixOf(const RigidTransform& transform);

// Distance between the origins of two frames, m, and angle between their axes,
// rad in [0, pi].
double OriginDistance(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b);
double AxesAngle(const Eigen::Matrix4d& a, const Eigen::Matrix4d& b);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_MATRIX_KINEMATICS_ORACLE_H_
