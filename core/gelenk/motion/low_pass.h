// A clip without its tremor: a Butterworth low-pass, forwards and backwards, so
// that nothing is delayed.
//
// On the manifold. A digital filter of second order makes each output of five
// earlier numbers with weights that sum to one: a weighted mean of points. Here
// the points are poses, and the mean is taken in the tangent space at the last
// output, the running reference:
//   y[n] = y[n-1] (+) (b0 (x[n] (-) y[n-1]) + b1 (x[n-1] (-) y[n-1])
//                      + b2 (x[n-2] (-) y[n-1]) - a2 (y[n-2] (-) y[n-1])).
// Numbers and rotations about one axis get exactly the filter of the books; no
// Euler angle is ever formed, and turning the whole motion turns the result.
// At the ends the motion is continued by its reflection through the end pose.
//
// With a cutoff below a tenth of the rate nothing turns more than 1.17 times as
// fast as the fastest turn before (the sum of the magnitudes of the impulse
// response), at the ends neither.
//
// Limit: from one frame to the next no joint may turn by half a turn or more.
// How far the filter lags behind the motion does not matter: whole turns
// between the two are kept count of. Source: Winter, "Biomechanics and Motor
// Control of Human Movement", ch. 3 (the cutoff of the two passes together).
#ifndef GELENK_MOTION_LOW_PASS_H_
#define GELENK_MOTION_LOW_PASS_H_

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// `frames` holds a pose a column, each of which passes CheckPositions, all
// `frame_time_s` apart. At `cutoff_hz` half of a movement's power is left, at
// twice that an eighth of its size. INVALID_ARGUMENT unless 0 < cutoff_hz <
// kMaxCutoffPart of the frame rate. Cost: linear; 60 joints take about 30 us a
// frame.
inline constexpr double kMaxCutoffPart = 0.4;
absl::StatusOr<Eigen::MatrixXd> LowPass(const Skeleton& skeleton,
                                        const Eigen::MatrixXd& frames,
                                        double frame_time_s, double cutoff_hz);

// The clip as frames at its frame time (see FrameTimeOf), filtered.
absl::StatusOr<MotionClip> LowPassClip(const MotionClip& clip,
                                       double cutoff_hz);

}  // namespace gelenk

#endif  // GELENK_MOTION_LOW_PASS_H_
