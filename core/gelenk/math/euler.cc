#include "gelenk/math/euler.h"

#include <cmath>
#include <numbers>

namespace gelenk {
namespace {

constexpr double kPi = std::numbers::pi;

// Below this length the sine or cosine of half the middle angle leaves one of
// the other two angles undetermined. Taking any value for it then changes the
// rotation by less than four times this, rad.
constexpr double kGimbalLock = 1e-11;

Eigen::Quaterniond Turn(int axis, double angle_rad) {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::Unit(axis)));
}

// `angle` with whole turns added until it is nearest to `near`.
double NearestTurn(double angle, double near) {
  return angle + 2 * kPi * std::round((near - angle) / (2 * kPi));
}

Eigen::Vector3d NearestTurns(const Eigen::Vector3d& angles,
                             const Eigen::Vector3d& near) {
  return {NearestTurn(angles[0], near[0]), NearestTurn(angles[1], near[1]),
          NearestTurn(angles[2], near[2])};
}

}  // namespace

Eigen::Quaterniond RotationFromEuler(const EulerAxes& axes,
                                     const Eigen::Vector3d& angles_rad) {
  return Turn(axes[0], angles_rad[0]) * Turn(axes[1], angles_rad[1]) *
         Turn(axes[2], angles_rad[2]);
}

Eigen::Vector3d EulerFromRotation(const EulerAxes& axes,
                                  const Eigen::Quaterniond& rotation,
                                  const Eigen::Vector3d& near_rad) {
  const int i = axes[0];
  const int j = axes[1];
  const int k = 3 - i - j;
  const double handedness = (j - i + 3) % 3 == 1 ? 1 : -1;
  // A Tait-Bryan order is the proper one i, j, i with the middle axis turned by
  // a right angle: R(k, c) = R(j, shift) * R(i, c) * R(j, -shift).
  const bool proper = axes[2] == i;
  const double shift = proper ? 0 : -handedness * kPi / 2;
  const Eigen::Quaterniond q = proper ? rotation : rotation * Turn(j, shift);

  // With sum = a + c, difference = a - c and the middle angle b + shift = m:
  //   w = cos(m/2) cos(sum/2)   q_j = sin(m/2) cos(difference/2)
  // q_i = cos(m/2) sin(sum/2)   q_k = +-sin(m/2) sin(difference/2)
  const double q_j = q.coeffs()[j];
  const double q_k = handedness * q.coeffs()[k];
  const double q_i = q.coeffs()[i];
  const double cosine = std::hypot(q.w(), q_i);
  const double sine = std::hypot(q_j, q_k);
  const double middle = 2 * std::atan2(sine, cosine);
  const double half_sum = std::atan2(q_i, q.w());
  const double half_difference = std::atan2(q_k, q_j);

  if (sine < kGimbalLock || cosine < kGimbalLock) {
    const double first = near_rad[0];
    const double third =
        sine < cosine ? 2 * half_sum - first : first - 2 * half_difference;
    return {first, NearestTurn(middle - shift, near_rad[1]),
            NearestTurn(third, near_rad[2])};
  }
  const double first = half_sum + half_difference;
  const double third = half_sum - half_difference;
  const Eigen::Vector3d one =
      NearestTurns({first, middle - shift, third}, near_rad);
  const Eigen::Vector3d other =
      NearestTurns({first + kPi, -middle - shift, third + kPi}, near_rad);
  return (one - near_rad).squaredNorm() <= (other - near_rad).squaredNorm()
             ? one
             : other;
}

}  // namespace gelenk
