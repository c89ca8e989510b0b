// Goals whose answer is known, and the errors of an answer by the oracle.
#ifndef GELENK_TESTS_TESTING_IK_TARGETS_H_
#define GELENK_TESTS_TESTING_IK_TARGETS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "gelenk/ik/goal.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/skeleton.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

// A goal called like its end effector.
Goal PositionGoalFor(const std::string& end_effector_id,
                     const Eigen::Vector3d& world_position);
Goal RotationGoalFor(const std::string& end_effector_id,
                     const Eigen::Quaterniond& world_rotation);
Goal PoseGoalFor(const std::string& end_effector_id,
                 const RigidTransform& world_pose);

// Where an end effector or joint is at `positions`, by forward kinematics.
RigidTransform EffectorPose(const Skeleton& skeleton,
                            const Eigen::VectorXd& positions,
                            absl::string_view id);

// A pose goal for each end effector of the skeleton, met at `positions`.
std::vector<Goal> PoseGoalsAt(const Skeleton& skeleton,
                              const Eigen::VectorXd& positions);

// `positions` moved by up to `size` per degree of freedom, inside the limits.
Eigen::VectorXd StartNear(Random& random, const Skeleton& skeleton,
                          const Eigen::VectorXd& positions, double size);

// How far the goal's effector is from its target by MatrixKinematicsOracle,
// with the skeleton at the origin: m and rad, 0 where the goal has no such
// part. Axis masks count, weights do not.
double OraclePositionError(const Skeleton& skeleton, const Goal& goal,
                           const Eigen::VectorXd& positions);
double OracleRotationError(const Skeleton& skeleton, const Goal& goal,
                           const Eigen::VectorXd& positions);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_IK_TARGETS_H_
