// Seeded random numbers, the same on every machine: the standard fixes the
// engine's bits, and the mapping to numbers is written here.
#ifndef GELENK_TESTS_TESTING_RANDOM_H_
#define GELENK_TESTS_TESTING_RANDOM_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <random>

#include "gelenk/math/rigid_transform.h"

namespace gelenk::testing {

using Random = std::mt19937_64;

// Uniform in [lower, upper).
double Uniform(Random& random, double lower, double upper);

// Uniform among 0 .. count - 1.
int UniformIndex(Random& random, int count);

bool WithProbability(Random& random, double probability);

// Coordinates uniform in [-size, size).
Eigen::Vector3d RandomVector(Random& random, double size);

// Uniform on the sphere.
Eigen::Vector3d RandomDirection(Random& random);

// Uniform over all rotations, either sign of the quaternion.
Eigen::Quaterniond RandomRotation(Random& random);

RigidTransform RandomTransform(Random& random, double size_m);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RANDOM_H_
