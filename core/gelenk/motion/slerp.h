// The way from one rotation to another, at constant speed.
#ifndef GELENK_MOTION_SLERP_H_
#define GELENK_MOTION_SLERP_H_

#include <cmath>

#include "gelenk/math/rotation.h"

namespace gelenk {

// At `u` of the shorter way from `a` (u = 0) to `b` (u = 1), in the hemisphere
// of `a`. The angle comes from the sum and difference of the two, which is
// exact where an arc cosine is not. u outside [0, 1] goes on the same way.
inline Eigen::Quaterniond Slerp(const Eigen::Quaterniond& a,
                                const Eigen::Quaterniond& b, double u) {
  const Eigen::Quaterniond near_b = InHemisphereOf(a, b);
  const double angle = 2 * std::atan2((a.coeffs() - near_b.coeffs()).norm(),
                                      (a.coeffs() + near_b.coeffs()).norm());
  // Below this sin(x)/x is 1 to the last digit.
  constexpr double kTinyAngle = 1e-8;
  const double sine = std::sin(angle);
  const double from =
      angle < kTinyAngle ? 1 - u : std::sin((1 - u) * angle) / sine;
  const double to = angle < kTinyAngle ? u : std::sin(u * angle) / sine;
  Eigen::Quaterniond q;
  q.coeffs() = from * a.coeffs() + to * near_b.coeffs();
  q.normalize();
  return q;
}

}  // namespace gelenk

#endif  // GELENK_MOTION_SLERP_H_
