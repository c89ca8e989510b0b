// Random states of a skeleton.
#ifndef GELENK_TESTS_TESTING_RANDOM_POSE_H_
#define GELENK_TESTS_TESTING_RANDOM_POSE_H_

#include <Eigen/Core>

#include "gelenk/skeleton/skeleton.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

// Anywhere, whatever the limits: angles in [-pi, pi), translations in
// [-1, 1) m, all rotations.
Eigen::VectorXd RandomPose(Random& random, const Skeleton& skeleton);

// Within the limits; where there are none, like RandomPose.
Eigen::VectorXd RandomPoseWithinLimits(Random& random,
                                       const Skeleton& skeleton);

// Numbers uniform in [-size, size).
Eigen::VectorXd RandomVelocity(Random& random, const Skeleton& skeleton,
                               double size);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RANDOM_POSE_H_
