#include "gelenk/motion/smoother.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

// Of a first-order low-pass with that cutoff.
double GainOf(double cutoff_hz, double dt_s) {
  const double turns = 2 * std::numbers::pi * cutoff_hz * dt_s;
  return turns / (1 + turns);
}

absl::Status Check(const SmootherOptions& options) {
  Violations violations;
  CheckNotNegative("time_constant_s", options.time_constant_s, violations);
  CheckPositive("min_cutoff_hz", options.min_cutoff_hz, violations);
  CheckNotNegative("speed_coefficient", options.speed_coefficient, violations);
  CheckPositive("speed_cutoff_hz", options.speed_cutoff_hz, violations);
  if (options.hampel) violations.AddStatus("hampel", Check(*options.hampel));
  return violations.ToStatus();
}

}  // namespace

absl::StatusOr<Smoother> Smoother::Create(
    std::shared_ptr<const Skeleton> skeleton, const SmootherOptions& options) {
  if (absl::Status status = Check(options); !status.ok()) return status;
  return Smoother(std::move(skeleton), options);
}

Smoother::Smoother(std::shared_ptr<const Skeleton> skeleton,
                   const SmootherOptions& options)
    : skeleton_(std::move(skeleton)),
      options_(options),
      parts_(PosePartsOf(*skeleton_)) {
  const int window = options.hampel ? 2 * options.hampel->reach + 1 : 0;
  window_.resize(skeleton_->position_count(), window);
  window_times_s_.resize(window);
  window_pointers_.resize(window);
  middle_ = smooth_ = last_ = skeleton_->rest_positions();
  velocity_ = change_ = Eigen::VectorXd::Zero(skeleton_->velocity_count());
}

void Smoother::Reset() {
  has_pushed_ = has_smooth_ = false;
  window_next_ = window_size_ = 0;
  latency_s_ = 0;
}

void Smoother::Exchange(StateNumbers& state) {
  state.Flag(has_pushed_);
  if (has_pushed_) state.Number(pushed_time_s_);
  state.Flag(has_smooth_);
  if (!has_smooth_) return;
  for (Eigen::VectorXd* pose : {&smooth_, &last_}) {
    state.Numbers(*pose);
    if (!state.is_reading() || !state.ok()) continue;
    const absl::Status status = CheckPositions(*skeleton_, *pose);
    if (!status.ok()) state.Refuse(status.message());
  }
  state.Numbers(velocity_);
  state.Number(last_time_s_);
  state.Number(latency_s_);
}

bool Smoother::PassWindow(double time_s, const ConstVectorView& positions) {
  if (!options_.hampel) {
    middle_ = positions;
    middle_time_s_ = time_s;
    return true;
  }
  const int count = static_cast<int>(window_.cols());
  window_.col(window_next_) = positions;
  window_times_s_[window_next_] = time_s;
  window_next_ = (window_next_ + 1) % count;
  window_size_ = std::min(window_size_ + 1, count);
  const int reach = options_.hampel->reach;
  if (window_size_ <= reach) return false;
  // While the window fills, poses go through as they are.
  const int middle = (window_next_ + count - 1 - reach) % count;
  middle_ = window_.col(middle);
  middle_time_s_ = window_times_s_[middle];
  if (window_size_ < count) return true;
  for (int i = 0; i < count; ++i) {
    window_pointers_[i] = window_.col((window_next_ + i) % count).data();
  }
  for (const PosePart& part : parts_) {
    Hampel(*options_.hampel, part, window_pointers_, middle_.data());
  }
  return true;
}

double Smoother::Gain(const PosePart& part, double dt_s) {
  switch (options_.kind) {
    case SmootherOptions::Kind::kNone:
      return 1;
    case SmootherOptions::Kind::kExponential:
      if (options_.time_constant_s == 0) return 1;
      return -std::expm1(-dt_s / options_.time_constant_s);
    case SmootherOptions::Kind::kOneEuro: {
      const double speed =
          velocity_.segment(part.velocity_offset, part.velocity_count).norm();
      return GainOf(options_.min_cutoff_hz + options_.speed_coefficient * speed,
                    dt_s);
    }
  }
  return 1;
}

bool Smoother::Push(double time_s, const ConstVectorView& positions,
                    VectorView smooth) {
  const bool is_late = has_pushed_ && !(time_s > pushed_time_s_);
  if (is_late || !std::isfinite(time_s)) return false;
  has_pushed_ = true;
  pushed_time_s_ = time_s;
  if (!PassWindow(time_s, positions)) return false;
  if (!has_smooth_) {
    has_smooth_ = true;
    smooth_ = last_ = middle_;
    velocity_.setZero();
    last_time_s_ = middle_time_s_;
    latency_s_ = time_s - middle_time_s_;
    smooth = smooth_;
    return true;
  }
  const double dt_s = middle_time_s_ - last_time_s_;
  Difference(*skeleton_, last_, middle_, change_);
  velocity_ +=
      GainOf(options_.speed_cutoff_hz, dt_s) * (change_ / dt_s - velocity_);
  last_ = middle_;
  last_time_s_ = middle_time_s_;
  Difference(*skeleton_, smooth_, middle_, change_);
  double lag_s = 0;
  for (const PosePart& part : parts_) {
    const double gain = Gain(part, dt_s);
    change_.segment(part.velocity_offset, part.velocity_count) *= gain;
    lag_s = std::max(lag_s, dt_s * (1 - gain) / gain);
  }
  Integrate(*skeleton_, smooth_, change_, smooth_);
  latency_s_ = time_s - middle_time_s_ + lag_s;
  smooth = smooth_;
  return true;
}

}  // namespace gelenk
