#include "gelenk/motion/hampel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/slerp.h"

namespace gelenk {
namespace {

constexpr int kMaxWindow = 2 * kMaxHampelReach + 1;
// A normal distribution's standard deviation is this times its median
// deviation.
constexpr double kSigmaOfMedian = 1.4826;

double Distance(const PosePart& part, const double* a, const double* b) {
  const double* pa = a + part.position_offset;
  const double* pb = b + part.position_offset;
  if (part.kind == PosePartKind::kRotation) {
    return AngleBetween(QuaternionXyzw(pa), QuaternionXyzw(pb));
  }
  double square = 0;
  for (int i = 0; i < part.position_count; ++i) {
    square += (pa[i] - pb[i]) * (pa[i] - pb[i]);
  }
  return std::sqrt(square);
}

void Between(const PosePart& part, const double* a, const double* b, double u,
             double* out) {
  const double* pa = a + part.position_offset;
  const double* pb = b + part.position_offset;
  double* po = out + part.position_offset;
  if (part.kind == PosePartKind::kRotation) {
    StoreXyzw(Slerp(QuaternionXyzw(pa), QuaternionXyzw(pb), u), po);
    return;
  }
  for (int i = 0; i < part.position_count; ++i) {
    po[i] = (1 - u) * pa[i] + u * pb[i];
  }
}

}  // namespace

absl::Status Check(const HampelOptions& options) {
  Violations violations;
  if (options.reach < 1 || options.reach > kMaxHampelReach) {
    violations.Add("reach", absl::StrFormat("want 1 to %d, got %d",
                                            kMaxHampelReach, options.reach));
  }
  CheckNotNegative("sigmas", options.sigmas, violations);
  CheckNotNegative("rotation_floor_rad", options.rotation_floor_rad,
                   violations);
  CheckNotNegative("number_floor", options.number_floor, violations);
  return violations.ToStatus();
}

bool Hampel(const HampelOptions& options, const PosePart& part,
            absl::Span<const double* const> window, double* middle) {
  const int count = static_cast<int>(window.size());
  const int center = count / 2;
  std::array<std::array<double, kMaxWindow>, kMaxWindow> distances;
  std::array<double, kMaxWindow> sums = {};
  for (int i = 0; i < count; ++i) {
    distances[i][i] = 0;
    for (int j = 0; j < i; ++j) {
      distances[i][j] = distances[j][i] = Distance(part, window[i], window[j]);
      sums[i] += distances[i][j];
      sums[j] += distances[i][j];
    }
  }
  const int medoid = static_cast<int>(
      std::min_element(sums.begin(), sums.begin() + count) - sums.begin());
  const std::array<double, kMaxWindow>& deviations = distances[medoid];
  std::array<double, kMaxWindow> sorted = deviations;
  std::nth_element(sorted.begin(), sorted.begin() + center,
                   sorted.begin() + count);
  const double floor = part.kind == PosePartKind::kRotation
                           ? options.rotation_floor_rad
                           : options.number_floor;
  const double most =
      std::max(floor, options.sigmas * kSigmaOfMedian * sorted[center]);
  const auto is_outlier = [&](int i) { return deviations[i] > most; };
  std::copy_n(window[center] + part.position_offset, part.position_count,
              middle + part.position_offset);
  if (!is_outlier(center)) return false;
  int before = center - 1;
  while (before > 0 && is_outlier(before)) --before;
  int after = center + 1;
  while (after < count - 1 && is_outlier(after)) ++after;
  if (is_outlier(before)) before = medoid;
  if (is_outlier(after)) after = medoid;
  const double u = before < center && after > center
                       ? static_cast<double>(center - before) / (after - before)
                       : 0.5;
  Between(part, window[before], window[after], u, middle);
  return true;
}

absl::StatusOr<HampelResult> RejectOutliers(const MotionClip& clip,
                                            const HampelOptions& options) {
  if (absl::Status status = Check(options); !status.ok()) return status;
  const absl::StatusOr<Eigen::MatrixXd> frames = FramesFromClip(clip);
  if (!frames.ok()) return frames.status();
  Eigen::MatrixXd clean = *frames;
  std::vector<Replacement> replaced;
  std::vector<const double*> window(2 * options.reach + 1);
  const std::vector<PosePart> parts = PosePartsOf(*clip.skeleton());
  const int last = static_cast<int>(frames->cols()) - options.reach;
  for (int frame = options.reach; frame < last; ++frame) {
    for (size_t i = 0; i < window.size(); ++i) {
      window[i] =
          frames->col(frame - options.reach + static_cast<int>(i)).data();
    }
    for (const PosePart& part : parts) {
      if (Hampel(options, part, window, clean.col(frame).data())) {
        replaced.push_back({frame, part.joint});
      }
    }
  }
  ClipProperties properties = clip.properties();
  properties.frame_time_s = FrameTimeOf(clip);
  absl::StatusOr<MotionClip> result =
      ClipFromFrames(clip.skeleton(), clean, std::move(properties));
  if (!result.ok()) return result.status();
  return HampelResult{*std::move(result), std::move(replaced)};
}

}  // namespace gelenk
