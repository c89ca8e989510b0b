#include "gelenk/ik/start_sampler.h"

#include <cmath>
#include <numbers>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// How far from the start an unbounded orientation or translation is drawn.
constexpr double kRotationReach = 1.2;  // rad
constexpr double kTranslationReach_m = 0.3;

}  // namespace

StartSampler::StartSampler(int64_t seed)
    : state_(static_cast<uint64_t>(seed)) {}

double StartSampler::Uniform(double lower, double upper) {
  // SplitMix64 (Steele, Lea, Flood 2014).
  state_ += 0x9E3779B97F4A7C15u;
  uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  const double unit = static_cast<double>(z >> 11) * 0x1p-53;
  return lower + (upper - lower) * unit;
}

void StartSampler::Sample(const Skeleton& skeleton,
                          const ConstVectorView& start, VectorView positions) {
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int q = skeleton.span(i).position_offset;
    if (q < 0) continue;
    const Joint& joint = skeleton.joint(i);
    const bool has_quaternion =
        joint.type == JointType::kSpherical || joint.type == JointType::kFree;
    const int scalars = joint.type == JointType::kFree
                            ? 3
                            : (has_quaternion ? 0 : PositionCount(joint.type));
    for (int k = 0; k < scalars; ++k) {
      const bool angle = joint.type == JointType::kRevolute ||
                         (joint.type == JointType::kPlanar && k == 2);
      const double reach = angle ? std::numbers::pi : kTranslationReach_m;
      double lower = angle ? -reach : start[q + k] - reach;
      double upper = angle ? reach : start[q + k] + reach;
      if (!joint.limits.lower.empty()) {
        if (std::isfinite(joint.limits.lower[k])) {
          lower = joint.limits.lower[k];
        }
        if (std::isfinite(joint.limits.upper[k])) {
          upper = joint.limits.upper[k];
        }
      }
      // A bound on one side only may lie beyond the default of the other.
      positions[q + k] = lower <= upper ? Uniform(lower, upper) : lower;
    }
    if (!has_quaternion) continue;
    const int at = q + scalars;
    const Eigen::Vector3d turn(Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1));
    const Eigen::Quaterniond drawn =
        QuaternionXyzw(start.data() + at) * ExpRotation(kRotationReach * turn);
    StoreXyzw(ClampRotation(joint.limits, joint.axis, drawn.normalized()),
              positions.data() + at);
  }
  ClampToLimits(skeleton, positions);
}

}  // namespace gelenk
