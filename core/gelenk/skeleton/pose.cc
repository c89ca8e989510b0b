#include "gelenk/skeleton/pose.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// Where the quaternion of a joint starts within its numbers; -1 without one.
int QuaternionStart(JointType type) {
  if (type == JointType::kSpherical) return 0;
  return type == JointType::kFree ? 3 : -1;
}

// Calls `visit(joint, q offset, v offset)` for each joint that owns numbers.
template <typename Visit>
void ForEachMoving(const Skeleton& skeleton, Visit visit) {
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const JointSpan& span = skeleton.span(i);
    if (span.position_offset < 0) continue;
    visit(i, span.position_offset, span.velocity_offset);
  }
}

// Calls `visit(joint, quaternion offset)` for each joint that owns one; knows
// without a look at the joints themselves.
template <typename Visit>
void ForEachQuaternion(const Skeleton& skeleton, Visit visit) {
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const int at = skeleton.span(i).quaternion_offset;
    if (at >= 0) visit(i, at);
  }
}

void CheckQuaternion(int at, VectorView positions, Violations& violations) {
  if (NormalizeNearUnit(positions.data() + at)) return;
  violations.Add(absl::StrCat("positions[", at, "]"),
                 absl::StrFormat("want a unit quaternion, got (%g, %g, %g, %g)",
                                 positions[at], positions[at + 1],
                                 positions[at + 2], positions[at + 3]));
}

}  // namespace

Eigen::VectorXd NeutralPositions(const Skeleton& skeleton) {
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(skeleton.position_count());
  ForEachQuaternion(skeleton, [&](int, int at) { positions[at + 3] = 1; });
  return positions;
}

absl::Status CheckPositions(const Skeleton& skeleton, VectorView positions) {
  Violations violations;
  if (positions.size() != skeleton.position_count()) {
    violations.Add("positions", absl::StrFormat("want %d numbers, got %d",
                                                skeleton.position_count(),
                                                positions.size()));
    return violations.ToStatus();
  }
  ForEachMoving(skeleton, [&](int i, int q, int) {
    CheckJointPositions(skeleton.joint(i).type, q, positions, violations);
  });
  return violations.ToStatus();
}

void CheckJointPositions(JointType type, int offset, VectorView positions,
                         Violations& violations) {
  const int count = PositionCount(type);
  for (int i = offset; i < offset + count; ++i) {
    if (IsUsable(positions[i])) continue;
    CheckNumber(absl::StrCat("positions[", i, "]"), positions[i], violations);
  }
  const int at = offset + QuaternionStart(type);
  if (at < offset || !positions.segment<4>(at).allFinite()) return;
  CheckQuaternion(at, positions, violations);
}

void Integrate(const Skeleton& skeleton, const ConstVectorView& positions,
               const ConstVectorView& velocity, VectorView result) {
  ForEachMoving(skeleton, [&](int i, int q, int v) {
    const JointType type = skeleton.joint(i).type;
    const int start = QuaternionStart(type);
    const int scalars = start < 0 ? PositionCount(type) : start;
    for (int k = 0; k < scalars; ++k) {
      result[q + k] = positions[q + k] + velocity[v + k];
    }
    if (start < 0) return;
    const Eigen::Quaterniond moved =
        (QuaternionXyzw(positions.data() + q + start) *
         ExpRotation(velocity.segment<3>(v + start)))
            .normalized();
    StoreXyzw(moved, result.data() + q + start);
  });
}

void Difference(const Skeleton& skeleton, const ConstVectorView& from,
                const ConstVectorView& to, VectorView result) {
  ForEachMoving(skeleton, [&](int i, int q, int v) {
    const JointType type = skeleton.joint(i).type;
    const int start = QuaternionStart(type);
    const int scalars = start < 0 ? PositionCount(type) : start;
    for (int k = 0; k < scalars; ++k) result[v + k] = to[q + k] - from[q + k];
    if (start < 0) return;
    result.segment<3>(v + start) =
        LogRotation(QuaternionXyzw(from.data() + q + start).conjugate() *
                    QuaternionXyzw(to.data() + q + start));
  });
}

double ClampToLimits(const Skeleton& skeleton, VectorView positions) {
  const PositionBounds& bounds = skeleton.position_bounds();
  double largest = 0;
  if (positions.size() > 0) {
    largest = std::max({largest, (bounds.lower - positions).maxCoeff(),
                        (positions - bounds.upper).maxCoeff()});
    positions = positions.cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  }
  ForEachQuaternion(skeleton, [&](int i, int at) {
    const Joint& joint = skeleton.joint(i);
    if (!joint.limits.HasRotationLimits()) return;
    const Eigen::Quaterniond rotation = QuaternionXyzw(positions.data() + at);
    const double excess =
        RotationLimitExcess(joint.limits, joint.axis, rotation);
    if (excess <= 0) return;
    largest = std::max(largest, excess);
    StoreXyzw(ClampRotation(joint.limits, joint.axis, rotation),
              positions.data() + at);
  });
  return largest;
}

double LimitExcess(const Skeleton& skeleton, const ConstVectorView& positions,
                   int* joint) {
  const PositionBounds& bounds = skeleton.position_bounds();
  double largest = 0;
  int worst = -1;
  const auto note = [&](int i, double excess) {
    if (excess <= largest) return;
    largest = excess;
    worst = i;
  };
  ForEachMoving(skeleton, [&](int i, int q, int) {
    const Joint& moving = skeleton.joint(i);
    for (int k = q; k < q + PositionCount(moving.type); ++k) {
      note(i, bounds.lower[k] - positions[k]);
      note(i, positions[k] - bounds.upper[k]);
    }
    const int start = QuaternionStart(moving.type);
    if (start < 0) return;
    note(i, RotationLimitExcess(moving.limits, moving.axis,
                                QuaternionXyzw(positions.data() + q + start)));
  });
  if (joint != nullptr) *joint = worst;
  return largest;
}

double ScalarPosition(const Skeleton& skeleton,
                      const ConstVectorView& positions, int joint) {
  const JointSpan& span = skeleton.span(joint);
  if (span.mimicked < 0) return positions[span.position_offset];
  const Mimic& mimic = *skeleton.joint(joint).mimic;
  return mimic.multiplier *
             positions[skeleton.span(span.mimicked).position_offset] +
         mimic.offset;
}

void AlignHemispheres(const Skeleton& skeleton,
                      const ConstVectorView& reference, VectorView positions) {
  ForEachQuaternion(skeleton, [&](int, int at) {
    if (reference.segment<4>(at).dot(positions.segment<4>(at)) < 0) {
      positions.segment<4>(at) *= -1;
    }
  });
}

}  // namespace gelenk
