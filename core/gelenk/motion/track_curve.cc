#include "gelenk/motion/track_curve.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "gelenk/math/rotation.h"
#include "gelenk/motion/slerp.h"

namespace gelenk {
namespace {

// A quaternion whose cubic comes this near to zero points nowhere.
constexpr double kNoDirection = 1e-12;

struct HermiteWeights {
  double from, out, to, in;
};

// For tangents per second; `h` is the length of the interval.
HermiteWeights HermiteAt(double u, double h) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  return {2 * u3 - 3 * u2 + 1, h * (u3 - 2 * u2 + u), 3 * u2 - 2 * u3,
          h * (u3 - u2)};
}

// Products of increments on the way from `q0` to `q1`, with angular velocities
// `v0` and `v1` at the ends.
Eigen::Quaterniond CumulativeBezier(const Eigen::Quaterniond& q0,
                                    const Eigen::Quaterniond& q1,
                                    const Eigen::Vector3d& v0,
                                    const Eigen::Vector3d& v1, double h,
                                    double u) {
  const Eigen::Vector3d w1 = h / 3 * v0;
  const Eigen::Vector3d w3 = h / 3 * v1;
  const Eigen::Vector3d w2 =
      LogRotation(ExpRotation(-w1) * q0.conjugate() * q1 * ExpRotation(-w3));
  const double u2 = u * u;
  const double u3 = u2 * u;
  const double b1 = 3 * u - 3 * u2 + u3;
  const double b2 = 3 * u2 - 2 * u3;
  return (q0 * ExpRotation(b1 * w1) * ExpRotation(b2 * w2) *
          ExpRotation(u3 * w3))
      .normalized();
}

}  // namespace

TrackCurve::TrackCurve(JointTrack track, const PosePart& part,
                       double duration_s, std::optional<double> seam_s)
    : track_(std::move(track)), part_(part) {
  if (track_.interpolation == Interpolation::kCatmullRom) {
    ComputeVelocities(duration_s, seam_s);
  }
}

Eigen::Vector3d TrackCurve::Velocity(int from, int to,
                                     double duration_s) const {
  if (part_.kind == PosePartKind::kRotation) {
    return LogRotation(
               QuaternionXyzw(track_.values.col(from).data()).conjugate() *
               QuaternionXyzw(track_.values.col(to).data())) /
           duration_s;
  }
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  velocity.head(part_.velocity_count) =
      (track_.values.col(to) - track_.values.col(from)) / duration_s;
  return velocity;
}

void TrackCurve::ComputeVelocities(double duration_s,
                                   std::optional<double> seam_s) {
  const int last = track_.key_count() - 1;
  velocities_ = Eigen::Matrix3Xd::Zero(3, last + 1);
  if (last == 0) return;
  const auto between = [this](int before, int key, int after, double h0,
                              double h1) {
    return Eigen::Vector3d(
        (h1 * Velocity(before, key, h0) + h0 * Velocity(key, after, h1)) /
        (h0 + h1));
  };
  const auto length = [this](int key) {
    return track_.times_s[key + 1] - track_.times_s[key];
  };
  for (int key = 1; key < last; ++key) {
    velocities_.col(key) =
        between(key - 1, key, key + 1, length(key - 1), length(key));
  }
  velocities_.col(0) = Velocity(0, 1, length(0));
  velocities_.col(last) = Velocity(last - 1, last, length(last - 1));
  const bool spans_clip =
      track_.times_s.front() == 0 && track_.times_s.back() == duration_s;
  if (!seam_s || !spans_clip) return;
  if (*seam_s > 0) {
    velocities_.col(0) = between(last, 0, 1, *seam_s, length(0));
    velocities_.col(last) =
        between(last - 1, last, 0, length(last - 1), *seam_s);
  } else {
    // The last key is the first again.
    velocities_.col(0) = (length(0) * velocities_.col(last) +
                          length(last - 1) * velocities_.col(0)) /
                         (length(0) + length(last - 1));
    velocities_.col(last) = velocities_.col(0);
  }
}

void TrackCurve::Sample(double time_s, int& cursor, double* positions) const {
  const std::vector<double>& times = track_.times_s;
  const int last = track_.key_count() - 1;
  double* out = positions + part_.position_offset;
  const auto copy = [&](int key) {
    std::copy_n(track_.values.col(key).data(), part_.position_count, out);
  };
  if (!(time_s > times.front())) {
    cursor = 0;
    return copy(0);
  }
  if (time_s >= times[last]) {
    cursor = last;
    return copy(last);
  }
  // The key at or before: mostly the same as last time or the next one.
  if (cursor >= last || times[cursor] > time_s || times[cursor + 1] <= time_s) {
    if (cursor + 2 <= last && times[cursor + 1] <= time_s &&
        time_s < times[cursor + 2]) {
      ++cursor;
    } else {
      cursor = static_cast<int>(
          std::upper_bound(times.begin(), times.end(), time_s) - times.begin() -
          1);
    }
  }
  if (time_s == times[cursor]) return copy(cursor);
  const double h = times[cursor + 1] - times[cursor];
  Interpolate(cursor, cursor + 1, h, (time_s - times[cursor]) / h, out);
}

void TrackCurve::SampleSeam(double part, double seam_s,
                            double* positions) const {
  const int last = track_.key_count() - 1;
  double* out = positions + part_.position_offset;
  if (part > 0 && part < 1) return Interpolate(last, 0, seam_s, part, out);
  std::copy_n(track_.values.col(part <= 0 ? last : 0).data(),
              part_.position_count, out);
}

void TrackCurve::Interpolate(int from, int to, double duration_s, double u,
                             double* out) const {
  const auto p0 = track_.values.col(from);
  const auto p1 = track_.values.col(to);
  Eigen::Map<Eigen::VectorXd> result(out, part_.position_count);
  const bool is_rotation = part_.kind == PosePartKind::kRotation;
  switch (track_.interpolation) {
    case Interpolation::kStep:
      result = p0;
      return;
    case Interpolation::kLinear:
      if (is_rotation) {
        StoreXyzw(
            Slerp(QuaternionXyzw(p0.data()), QuaternionXyzw(p1.data()), u),
            out);
      } else {
        result = (1 - u) * p0 + u * p1;
      }
      return;
    case Interpolation::kCubicSpline: {
      const HermiteWeights w = HermiteAt(u, duration_s);
      result = w.from * p0 + w.out * track_.out_tangents.col(from) + w.to * p1 +
               w.in * track_.in_tangents.col(to);
      if (!is_rotation) return;
      const double norm = result.norm();
      if (norm > kNoDirection) {
        result /= norm;
      } else {
        result = u < 0.5 ? p0 : p1;
      }
      return;
    }
    case Interpolation::kCatmullRom:
      if (is_rotation) {
        StoreXyzw(
            CumulativeBezier(QuaternionXyzw(p0.data()),
                             QuaternionXyzw(p1.data()), velocities_.col(from),
                             velocities_.col(to), duration_s, u),
            out);
      } else {
        const HermiteWeights w = HermiteAt(u, duration_s);
        for (int i = 0; i < part_.position_count; ++i) {
          out[i] = w.from * p0[i] + w.out * velocities_(i, from) +
                   w.to * p1[i] + w.in * velocities_(i, to);
        }
      }
      return;
  }
}

}  // namespace gelenk
