#include "tests/testing/random.h"

#include <cmath>
#include <numbers>

namespace gelenk::testing {

double Uniform(Random& random, double lower, double upper) {
  const double unit = static_cast<double>(random() >> 11) * 0x1p-53;
  return lower + unit * (upper - lower);
}

int UniformIndex(Random& random, int count) {
  return static_cast<int>(Uniform(random, 0, count));
}

bool WithProbability(Random& random, double probability) {
  return Uniform(random, 0, 1) < probability;
}

Eigen::Vector3d RandomVector(Random& random, double size) {
  const double x = Uniform(random, -size, size);
  const double y = Uniform(random, -size, size);
  const double z = Uniform(random, -size, size);
  return {x, y, z};
}

Eigen::Vector3d RandomDirection(Random& random) {
  // Slices of equal height of a sphere have equal area (Archimedes).
  const double z = Uniform(random, -1, 1);
  const double longitude = Uniform(random, 0, 2 * std::numbers::pi);
  const double radius = std::sqrt(1 - z * z);
  return {radius * std::cos(longitude), radius * std::sin(longitude), z};
}

Eigen::Quaterniond RandomRotation(Random& random) {
  // Shoemake, "Uniform random rotations", Graphics Gems III.
  const double u = Uniform(random, 0, 1);
  const double a = Uniform(random, 0, 2 * std::numbers::pi);
  const double b = Uniform(random, 0, 2 * std::numbers::pi);
  return Eigen::Quaterniond(
      std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
      std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b));
}

RigidTransform RandomTransform(Random& random, double size_m) {
  const Eigen::Quaterniond rotation = RandomRotation(random);
  return {rotation, RandomVector(random, size_m)};
}

}  // namespace gelenk::testing
