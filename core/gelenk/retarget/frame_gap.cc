#include "gelenk/retarget/frame_gap.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

double SmoothStep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

}  // namespace

absl::Status CheckGapOptions(const GapOptions& options) {
  Violations violations;
  const auto check = [&](absl::string_view field, double value) {
    if (std::isfinite(value) && value >= 0) return;
    violations.Add(field, absl::StrFormat("want 0 or more, got %g", value));
  };
  check("extrapolation_s", options.extrapolation_s);
  check("hold_s", options.hold_s);
  check("ease_s", options.ease_s);
  return violations.ToStatus();
}

FrameGap::FrameGap(std::shared_ptr<const Skeleton> skeleton,
                   const ConstVectorView& rest_positions,
                   const GapOptions& options)
    : skeleton_(std::move(skeleton)),
      options_(options),
      rest_(rest_positions),
      last_(rest_positions),
      velocity_(Eigen::VectorXd::Zero(skeleton_->velocity_count())),
      step_(velocity_),
      held_(rest_positions),
      filled_(rest_positions) {}

void FrameGap::Take(const ConstVectorView& positions, double dt_s) {
  // Over a gap the speed says nothing about now.
  if (has_frame() && gap_s_ == 0) {
    Difference(*skeleton_, last_, positions, velocity_);
    velocity_ /= dt_s;
  } else {
    velocity_.setZero();
  }
  last_ = positions;
  filled_ = positions;
  gap_s_ = 0;
  frame_count_ = std::min(frame_count_ + 1, 2);
}

const Eigen::VectorXd& FrameGap::Fill(double dt_s) {
  gap_s_ += dt_s;
  held_ = last_;
  if (options_.policy == GapPolicy::kExtrapolate &&
      options_.extrapolation_s > 0) {
    const double ahead_s = options_.extrapolation_s *
                           (1 - std::exp(-gap_s_ / options_.extrapolation_s));
    step_ = ahead_s * velocity_;
    Integrate(*skeleton_, last_, step_, held_);
  }
  const double since = gap_s_ - options_.hold_s;
  const double eased = options_.ease_s > 0 ? SmoothStep(since / options_.ease_s)
                                           : (since >= 0 ? 1.0 : 0.0);
  Difference(*skeleton_, held_, rest_, step_);
  // The root, or what stands for it, stays where it is.
  const int root = VelocityCount(skeleton_->joint(0).type);
  step_.head(root).setZero();
  step_ *= eased;
  Integrate(*skeleton_, held_, step_, filled_);
  return filled_;
}

}  // namespace gelenk
