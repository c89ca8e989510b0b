#include "tests/testing/random_pose.h"

#include <cmath>
#include <numbers>

#include "gelenk/math/rotation.h"

namespace gelenk::testing {
namespace {

constexpr double kPi = std::numbers::pi;

enum class Range { kAnywhere, kWithinLimits };

// Half the width of what number `k` of a joint is drawn from without limits.
double FreeReach(JointType type, int k) {
  const bool angle =
      type == JointType::kRevolute || (type == JointType::kPlanar && k == 2);
  return angle ? kPi : 1;
}

double RandomNumber(Random& random, const Joint& joint, int k, Range range) {
  const double reach = FreeReach(joint.type, k);
  if (range == Range::kAnywhere || joint.limits.lower.empty()) {
    return Uniform(random, -reach, reach);
  }
  const double lower = joint.limits.lower[k];
  const double upper = joint.limits.upper[k];
  // Infinite limits leave that side open.
  if (std::isfinite(lower) && std::isfinite(upper)) {
    return Uniform(random, lower, upper);
  }
  if (std::isfinite(lower)) return Uniform(random, lower, lower + 2 * reach);
  if (std::isfinite(upper)) return Uniform(random, upper - 2 * reach, upper);
  return Uniform(random, -reach, reach);
}

Eigen::Quaterniond RandomRotationWithin(Random& random, const Joint& joint) {
  const JointLimits& limits = joint.limits;
  if (!limits.HasRotationLimits()) return RandomRotation(random);
  // Short of a swing of pi, where the twist is undefined.
  const double swing =
      Uniform(random, 0, limits.swing_cone_rad.value_or(kPi - 1e-3));
  const double twist = Uniform(random, limits.twist_lower_rad.value_or(-kPi),
                               limits.twist_upper_rad.value_or(kPi));
  const Eigen::Vector3d across =
      joint.axis.cross(RandomDirection(random)).normalized();
  return Eigen::Quaterniond(Eigen::AngleAxisd(swing, across)) *
         Eigen::Quaterniond(Eigen::AngleAxisd(twist, joint.axis));
}

Eigen::VectorXd Draw(Random& random, const Skeleton& skeleton, Range range) {
  Eigen::VectorXd positions(skeleton.position_count());
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int offset = skeleton.span(i).position_offset;
    if (offset < 0) continue;
    const Joint& joint = skeleton.joint(i);
    const bool rotates =
        joint.type == JointType::kSpherical || joint.type == JointType::kFree;
    const int numbers = PositionCount(joint.type) - (rotates ? 4 : 0);
    for (int k = 0; k < numbers; ++k) {
      positions[offset + k] = RandomNumber(random, joint, k, range);
    }
    if (!rotates) continue;
    StoreXyzw(range == Range::kAnywhere ? RandomRotation(random)
                                        : RandomRotationWithin(random, joint),
              positions.data() + offset + numbers);
  }
  return positions;
}

}  // namespace

Eigen::VectorXd RandomPose(Random& random, const Skeleton& skeleton) {
  return Draw(random, skeleton, Range::kAnywhere);
}

Eigen::VectorXd RandomPoseWithinLimits(Random& random,
                                       const Skeleton& skeleton) {
  return Draw(random, skeleton, Range::kWithinLimits);
}

Eigen::VectorXd RandomVelocity(Random& random, const Skeleton& skeleton,
                               double size) {
  Eigen::VectorXd velocity(skeleton.velocity_count());
  for (double& number : velocity) number = Uniform(random, -size, size);
  return velocity;
}

}  // namespace gelenk::testing
