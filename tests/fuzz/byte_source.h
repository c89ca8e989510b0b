// Reads choices and numbers off the bytes of a fuzzer: every byte string says
// something, a small change of it changes little, and what is not there is 0.
#ifndef GELENK_TESTS_FUZZ_BYTE_SOURCE_H_
#define GELENK_TESTS_FUZZ_BYTE_SOURCE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>

#include "gelenk/math/rigid_transform.h"

namespace gelenk {

class ByteSource {
 public:
  // The first byte says whether numbers may be odd and choices wrong.
  ByteSource(const uint8_t* data, size_t size)
      : at_(data), left_(size), is_wild_(OneIn(4)) {}

  uint8_t Byte() {
    if (left_ == 0) return 0;
    --left_;
    return *at_++;
  }

  // 0 .. count - 1.
  int Below(int count) { return Byte() % count; }

  bool OneIn(int count) { return Below(count) == count - 1; }

  // A choice that is probably refused.
  bool GoWrong() { return is_wild_ && OneIn(32); }

  // Between -4 and 4 but for odd numbers.
  double Number() {
    if (GoWrong()) return OddNumber();
    const int high = static_cast<int8_t>(Byte());
    return (high * 256 + Byte()) / 8192.0;
  }

  // Of a length of about `size`.
  Eigen::Vector3d Vector(double size) {
    const double x = Number();
    const double y = Number();
    const double z = Number();
    return size / 4 * Eigen::Vector3d(x, y, z);
  }

  // Unit, but for what cannot be made so.
  Eigen::Vector3d Direction() {
    const Eigen::Vector3d v = Vector(4);
    return v.norm() > 0 ? Eigen::Vector3d(v.normalized())
                        : Eigen::Vector3d::UnitZ();
  }

  Eigen::Quaterniond Rotation() {
    const Eigen::Vector3d v = Vector(4);
    return Eigen::Quaterniond(1, v.x(), v.y(), v.z()).normalized();
  }

  RigidTransform Transform(double size) {
    const Eigen::Quaterniond rotation =
        OneIn(2) ? Rotation() : Eigen::Quaterniond::Identity();
    return {rotation, Vector(size)};
  }

 private:
  double OddNumber() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kNumbers[] = {0,
                                   -0.0,
                                   1,
                                   3.141592653589793,
                                   -3.141592653589793,
                                   1e-12,
                                   1e-160,
                                   5e-324,
                                   1e6,
                                   -1e9,
                                   1e160,
                                   1.7e308,
                                   kInfinity,
                                   -kInfinity,
                                   std::numeric_limits<double>::quiet_NaN()};
    return kNumbers[Below(static_cast<int>(std::size(kNumbers)))];
  }

  const uint8_t* at_;
  size_t left_;
  bool is_wild_;
};

}  // namespace gelenk

#endif  // GELENK_TESTS_FUZZ_BYTE_SOURCE_H_
