#include "gelenk/ik/start_sampler.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gelenk/ik/kernel/split_mix.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// How far from the start an unbounded orientation or translation is drawn.
constexpr double kRotationReach = 1.2;  // rad
constexpr double kTranslationReach_m = 0.3;
// Two turns in other digits are two turns.
constexpr double kRounding = 1e-6;
// A slide with limits further apart is as good as without any.
constexpr double kWidestSlide_m = 1e3;

}  // namespace

StartRange RangeOfStarts(bool is_angle, double start, double lower,
                         double upper) {
  const double reach = is_angle ? std::numbers::pi : kTranslationReach_m;
  const double widest = is_angle ? 4 * std::numbers::pi : kWidestSlide_m;
  const double center = is_angle ? 0 : start;
  const double width = upper - lower;
  if (std::isfinite(width) && width > widest * (1 + kRounding)) {
    lower = std::clamp(center - reach, lower, upper - 2 * reach);
    return {lower, lower + 2 * reach};
  }
  // A bound on one side only may lie beyond the default of the other.
  if (!std::isfinite(lower)) lower = std::min(center - reach, upper);
  if (!std::isfinite(upper)) upper = std::max(center + reach, lower);
  return {lower, upper};
}

StartSampler::StartSampler(int64_t seed)
    : state_(static_cast<uint64_t>(seed)) {}

double StartSampler::Uniform(double lower, double upper) {
  return kernel::NextUniform(state_, lower, upper);
}

void StartSampler::Sample(const Skeleton& skeleton,
                          absl::Span<const int> joints,
                          const ConstVectorView& start, VectorView positions) {
  for (int joint : joints) SampleJoint(skeleton, joint, start, positions);
}

void StartSampler::SampleJoint(const Skeleton& skeleton, int index,
                               const ConstVectorView& start,
                               VectorView positions) {
  const Joint& joint = skeleton.joint(index);
  const PositionBounds& bounds = skeleton.position_bounds();
  const int q = skeleton.span(index).position_offset;
  const bool has_quaternion =
      joint.type == JointType::kSpherical || joint.type == JointType::kFree;
  const int scalars = PositionCount(joint.type) - (has_quaternion ? 4 : 0);
  for (int k = 0; k < scalars; ++k) {
    const bool angle = joint.type == JointType::kRevolute ||
                       (joint.type == JointType::kPlanar && k == 2);
    const StartRange range = RangeOfStarts(
        angle, start[q + k], bounds.lower[q + k], bounds.upper[q + k]);
    positions[q + k] = Uniform(range.lower, range.upper);
  }
  if (!has_quaternion) return;
  const int at = q + scalars;
  const double x = Uniform(-1, 1);
  const double y = Uniform(-1, 1);
  const double z = Uniform(-1, 1);
  const Eigen::Quaterniond drawn =
      QuaternionXyzw(start.data() + at) *
      ExpRotation(kRotationReach * Eigen::Vector3d(x, y, z));
  StoreXyzw(ClampRotation(joint.limits, joint.axis, drawn.normalized()),
            positions.data() + at);
}

}  // namespace gelenk
