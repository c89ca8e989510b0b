// Rotations: unit Hamilton quaternions, stored and sent in the order x y z w.
//
// Errors: none; callers check with CheckUnit at the border.
#ifndef GELENK_MATH_ROTATION_H_
#define GELENK_MATH_ROTATION_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace gelenk {

// The one place that turns stored numbers into a quaternion: Eigen's
// constructor takes w first, everything stored has w last.
inline Eigen::Quaterniond QuaternionXyzw(double x, double y, double z,
                                         double w) {
  return Eigen::Quaterniond(w, x, y, z);
}
inline Eigen::Quaterniond QuaternionXyzw(const double* xyzw) {
  return QuaternionXyzw(xyzw[0], xyzw[1], xyzw[2], xyzw[3]);
}
inline void StoreXyzw(const Eigen::Quaterniond& q, double* xyzw) {
  xyzw[0] = q.x(), xyzw[1] = q.y(), xyzw[2] = q.z(), xyzw[3] = q.w();
}

// How a norm is read at the border: within kUnitExact the quaternion is taken
// as it is, so that a pose comes round bit by bit; within kUnitTolerance it is
// normalised; beyond, refused.
inline constexpr double kUnitExact = 1e-12;
inline constexpr double kUnitTolerance = 1e-3;

// Reads the quaternion at `xyzw` in place by that rule; false when it is beyond
// tolerance or not finite.
bool NormalizeNearUnit(double* xyzw);

// Rotation by |rotation_vector| rad about it, and back: the result of Log is at
// most pi long.
Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& rotation_vector);
Eigen::Vector3d LogRotation(const Eigen::Quaterniond& rotation);

// Angle between two orientations, rad in [0, pi].
double AngleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b);

// `q`, or the same rotation as -q, whichever lies in the hemisphere of
// `reference`.
Eigen::Quaterniond InHemisphereOf(const Eigen::Quaterniond& reference,
                                  const Eigen::Quaterniond& q);

// Shortest rotation that takes unit vector `from` to unit vector `to`. Between
// opposite vectors half a turn about one perpendicular axis; for Z that is -Y.
Eigen::Quaterniond ShortestRotation(const Eigen::Vector3d& from,
                                    const Eigen::Vector3d& to);

// A rotation as swing * twist about `axis`: twist first about the axis, then
// the swing, whose own axis is perpendicular to it.
struct SwingTwist {
  // Angle between the axis and its image, rad in [0, pi].
  double swing_rad = 0;
  // Unit, perpendicular to the axis; any such vector without swing.
  Eigen::Vector3d swing_axis = Eigen::Vector3d::UnitX();
  // rad in (-pi, pi]; 0 at a swing of pi, where it is undefined.
  double twist_rad = 0;
};
SwingTwist DecomposeSwingTwist(const Eigen::Quaterniond& rotation,
                               const Eigen::Vector3d& axis);
Eigen::Quaterniond ComposeSwingTwist(const SwingTwist& parts,
                                     const Eigen::Vector3d& axis);

}  // namespace gelenk

#endif  // GELENK_MATH_ROTATION_H_
