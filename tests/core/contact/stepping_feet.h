// Feet that stand, step and slide as told, without a body.
#ifndef GELENK_TESTS_CORE_CONTACT_STEPPING_FEET_H_
#define GELENK_TESTS_CORE_CONTACT_STEPPING_FEET_H_

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "gelenk/contact/foot_points.h"

namespace gelenk {

// A flat foot whose heel is at `heel`, 0.25 m long, pointing along `yaw_rad`
// from +Z.
inline std::array<Eigen::Vector3d, kFootPointCount> FlatFoot(
    const Eigen::Vector3d& heel, double yaw_rad = 0) {
  const Eigen::Vector3d ahead(std::sin(yaw_rad), 0, std::cos(yaw_rad));
  return {heel, heel + 0.18 * ahead, heel + 0.25 * ahead};
}

// The right foot stands at x = -0.1; the left one stands for a second, is
// swung 0.6 m forward and 0.15 m up within half a second, and stands again.
inline std::vector<FootPoints> OneStep(double frame_time_s,
                                       double floor_m = 0) {
  std::vector<FootPoints> frames;
  const int count = static_cast<int>(std::lround(2.5 / frame_time_s));
  for (int f = 0; f < count; ++f) {
    const double time = f * frame_time_s;
    const double part = std::min(1.0, std::max(0.0, (time - 1) / 0.5));
    const double eased = part * part * (3 - 2 * part);
    const Eigen::Vector3d heel(
        0.1, floor_m + 0.15 * std::sin(std::numbers::pi * part), 0.6 * eased);
    frames.push_back({FlatFoot(heel), FlatFoot({-0.1, floor_m, 0})});
  }
  return frames;
}

// The same with white noise of `deviation_m` along every axis, which all points
// of a frame have in common, as when the root of a capture trembles.
inline std::vector<FootPoints> Trembling(std::vector<FootPoints> frames,
                                         double deviation_m) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, deviation_m);
  for (FootPoints& frame : frames) {
    const Eigen::Vector3d error(noise(random), noise(random), noise(random));
    for (auto& foot : frame) {
      for (Eigen::Vector3d& point : foot) point += error;
    }
  }
  return frames;
}

}  // namespace gelenk

#endif  // GELENK_TESTS_CORE_CONTACT_STEPPING_FEET_H_
