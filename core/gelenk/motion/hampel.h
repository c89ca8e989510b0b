// Single samples that are not part of the motion: a marker swapped, a sensor
// that sneezed.
//
// Per part of a pose (see PosePart) and frame: within a window around it the
// sample that is nearest to all others stands for the median; the frame is an
// outlier when it is farther from that than `sigmas` times the window's median
// distance, scaled to a standard deviation, and than the floor. It is replaced
// by the way between its nearest neighbours that are none. Distances are angles
// between rotations, and lengths of differences of numbers.
// Source: Hampel, "The influence curve and its role in robust estimation"
// (1974); the median of rotations is the medoid.
#ifndef GELENK_MOTION_HAMPEL_H_
#define GELENK_MOTION_HAMPEL_H_

#include <Eigen/Core>
#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/motion/motion_clip.h"
#include "gelenk/motion/pose_part.h"

namespace gelenk {

struct HampelOptions {
  // Frames on either side, 1 to kMaxHampelReach.
  int reach = 3;
  double sigmas = 3;
  // Never an outlier below, rad and m (or rad, of angles).
  double rotation_floor_rad = 0.03;
  double number_floor = 0.01;
};

inline constexpr int kMaxHampelReach = 8;

absl::Status Check(const HampelOptions& options);

// `window` holds 2 reach + 1 poses, `part`'s numbers of which are looked at;
// writes what should be in the middle, and returns whether that is another.
// Allocates nothing.
bool Hampel(const HampelOptions& options, const PosePart& part,
            absl::Span<const double* const> window, double* middle);

struct Replacement {
  int frame;
  int joint;
};

struct HampelResult {
  MotionClip clip;
  std::vector<Replacement> replaced;
};

// The clip as frames at its frame time, without its outliers. The first and
// last `reach` frames have no whole window and stay. INVALID_ARGUMENT naming
// the option. Cost: linear in the frames, quadratic in the reach.
absl::StatusOr<HampelResult> RejectOutliers(const MotionClip& clip,
                                            const HampelOptions& options = {});

}  // namespace gelenk

#endif  // GELENK_MOTION_HAMPEL_H_
