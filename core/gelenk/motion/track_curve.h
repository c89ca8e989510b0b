// A track as a function of time.
//
// kCatmullRom on rotations: each key has an angular velocity, the mean of those
// of the turns before and after it, each weighted with the length of the other
// (the ends of a track that is no cycle take that of their one turn). Between
// keys runs a cubic Bezier curve in cumulative form,
//   q(u) = q0 exp(b1(u) w1) exp(b2(u) w2) exp(b3(u) w3),
// which has those velocities at its ends: keys are hit, the angular velocity is
// continuous however unevenly the keys lie, and a turn at constant speed comes
// out as such. Squad has none but the first on uneven keys.
// Source: Kim, Kim and Shin, "A General Construction Scheme for Unit Quaternion
// Curves with Simple High Order Derivatives" (SIGGRAPH 1995).
#ifndef GELENK_MOTION_TRACK_CURVE_H_
#define GELENK_MOTION_TRACK_CURVE_H_

#include <Eigen/Core>
#include <optional>

#include "gelenk/motion/joint_track.h"
#include "gelenk/motion/pose_part.h"

namespace gelenk {

class TrackCurve {
 public:
  // `track` has passed CheckAndNormalize. `seam_s` as in ClipProperties: given
  // for a cycle, in which tangents at the ends look across the seam.
  TrackCurve(JointTrack track, const PosePart& part, double duration_s,
             std::optional<double> seam_s);

  const JointTrack& track() const { return track_; }
  const PosePart& part() const { return part_; }

  // Writes the part's numbers of `positions` (a whole q). Before the first key
  // that one holds, after the last one that. `cursor`, 0 at first, is where to
  // look: O(1) while times move on, O(log keys) after a jump. At a key its
  // value is met exactly. Allocates nothing.
  void Sample(double time_s, int& cursor, double* positions) const;

  // On the way from the last key to the first of the next round, at `part` of
  // it in [0, 1].
  void SampleSeam(double part, double seam_s, double* positions) const;

 private:
  void ComputeVelocities(double duration_s, std::optional<double> seam_s);
  // Of the motion from one key to another in `duration_s`.
  Eigen::Vector3d Velocity(int from, int to, double duration_s) const;
  // Between keys, at `u` of it in (0, 1).
  void Interpolate(int from, int to, double duration_s, double u,
                   double* out) const;

  JointTrack track_;
  PosePart part_;
  // kCatmullRom only: per key, per second, body frame for rotations. Parts have
  // at most three degrees of freedom.
  Eigen::Matrix3Xd velocities_;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_TRACK_CURVE_H_
