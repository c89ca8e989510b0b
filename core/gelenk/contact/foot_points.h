// The points of a foot that touch the ground.
//
// Everything about contacts is told in canonical coordinates: m, X to the
// left, Y up, Z forward; and for a leg of kReferenceLegM: lengths and speeds
// that are thresholds grow with the leg.
#ifndef GELENK_CONTACT_FOOT_POINTS_H_
#define GELENK_CONTACT_FOOT_POINTS_H_

#include <Eigen/Core>
#include <array>

namespace gelenk {

// Thigh and shin of the body for which thresholds are given.
inline constexpr double kReferenceLegM = 0.85;

inline constexpr int kHeel = 0;
inline constexpr int kBall = 1;  // the joint of the toes
inline constexpr int kTip = 2;   // of the toes
inline constexpr int kFootPointCount = 3;

// [side][point], left first.
template <typename Value>
using PerFootPoint = std::array<std::array<Value, kFootPointCount>, 2>;

using FootPoints = PerFootPoint<Eigen::Vector3d>;
// How high each point is above the sole of a foot that stands flat.
using PlantedHeights = PerFootPoint<double>;

inline Eigen::Vector3d Horizontal(const Eigen::Vector3d& v) {
  return {v.x(), 0, v.z()};
}

}  // namespace gelenk

#endif  // GELENK_CONTACT_FOOT_POINTS_H_
