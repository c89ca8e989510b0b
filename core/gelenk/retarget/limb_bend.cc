#include "gelenk/retarget/limb_bend.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "gelenk/math/rotation.h"

namespace gelenk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

// A limb that is bent this much (sine) tells its plane fully.
constexpr double kFullBend = 0.35;
// A plane that turns against the remembered one by more, of a limb that is less
// than fully bent, is a joint that bends backwards a little: noise.
constexpr double kMaxOpposition = -0.2;
// How fast the plane turns about the limb.
constexpr double kMaxPlaneSpeed = 1200 * std::numbers::pi / 180;
// Less of a bend has no plane.
constexpr double kMinBendPart = 1e-3;

// The frame whose first axis is `x` and whose third is nearest to `z`.
Eigen::Matrix3d FrameOf(const Vector3d& x, const Vector3d& z) {
  Eigen::Matrix3d frame;
  frame.col(0) = x;
  frame.col(2) = (z - x * x.dot(z)).normalized();
  frame.col(1) = frame.col(2).cross(x);
  return frame;
}

}  // namespace

void LimbBend::Remember(const Vector3d& bend, const Quaterniond& anatomical,
                        double dt_s) {
  const double part = std::min(1.0, bend.norm() / kFullBend);
  const bool is_first = std::exchange(is_first_, false);
  if (part < kMinBendPart) return;
  const Vector3d plane = anatomical.conjugate() * bend.normalized();
  if (part < 1 && plane.dot(normal_) < kMaxOpposition) return;
  const Quaterniond turn = ShortestRotation(normal_, plane);
  const double angle = AngleBetween(Quaterniond::Identity(), turn);
  double way = part * part;
  if (!is_first && way * angle > kMaxPlaneSpeed * dt_s) {
    way = kMaxPlaneSpeed * dt_s / angle;
  }
  normal_ = (Quaterniond::Identity().slerp(way, turn) * normal_).normalized();
}

void LimbBend::Bend(const Vector3d& goal, double dt_s, LimbPose& limb) {
  const Vector3d upper = (limb.middle - limb.root).stableNormalized();
  const Vector3d lower = (limb.end - limb.middle).stableNormalized();
  const Quaterniond anatomical = limb.upper * anatomy_.conjugate();
  Remember(upper.cross(lower), anatomical, dt_s);
  Vector3d normal = anatomical * normal_;
  normal -= upper * upper.dot(normal);
  if (normal.norm() < 1e-6) normal = upper.unitOrthogonal();
  normal.normalize();

  const Vector3d reach = limb.end - limb.root;
  const Vector3d wanted = goal - limb.root;
  const double total = lengths_.Total();
  const double distance = std::clamp(
      wanted.norm(),
      std::abs(lengths_.upper - lengths_.lower) + kMinLimbReach * total,
      kMaxLimbReach * total);
  const Vector3d now = reach.stableNormalized();
  const Vector3d direction =
      wanted.norm() > 1e-6 ? Vector3d(wanted.normalized()) : now;
  Vector3d turned = ShortestRotation(now, direction) * normal;
  turned -= direction * direction.dot(turned);
  turned.normalize();

  const double cosine = (lengths_.upper * lengths_.upper + distance * distance -
                         lengths_.lower * lengths_.lower) /
                        (2 * lengths_.upper * distance);
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  const Vector3d new_upper = Eigen::AngleAxisd(-angle, turned) * direction;
  const Vector3d new_lower =
      (distance * direction - lengths_.upper * new_upper).normalized();
  const auto turn = [&](const Vector3d& from, const Vector3d& to) {
    return Quaterniond(FrameOf(to, turned) * FrameOf(from, normal).transpose());
  };
  limb.upper = (turn(upper, new_upper) * limb.upper).normalized();
  limb.lower = (turn(lower, new_lower) * limb.lower).normalized();
  limb.middle = limb.root + lengths_.upper * new_upper;
  limb.end = limb.root + distance * direction;
}

}  // namespace gelenk
