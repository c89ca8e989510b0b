#include "gelenk/motion/first_frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

struct Turn {
  int joint = -1;
  double angle_rad = 0;
};

// How far the motion `velocity` turns `joint`.
double AngleOf(const Skeleton& skeleton, int joint,
               const Eigen::VectorXd& velocity) {
  const int offset = skeleton.span(joint).velocity_offset;
  if (offset < 0) return 0;
  switch (skeleton.joint(joint).type) {
    case JointType::kFixed:
    case JointType::kPrismatic:
      return 0;
    case JointType::kRevolute:
      return std::abs(std::remainder(velocity[offset], 2 * std::numbers::pi));
    case JointType::kPlanar:
      return std::abs(
          std::remainder(velocity[offset + 2], 2 * std::numbers::pi));
    case JointType::kSpherical:
      return velocity.segment<3>(offset).norm();
    case JointType::kFree:
      return velocity.segment<3>(offset + 3).norm();
  }
  return 0;
}

Turn LargestTurn(const Skeleton& skeleton, const Eigen::VectorXd& velocity) {
  Turn largest;
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const double angle = AngleOf(skeleton, i, velocity);
    if (angle > largest.angle_rad) largest = {i, angle};
  }
  return largest;
}

double Median(std::vector<double> values) {
  const auto middle =
      values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<FirstFrameJump> FindFirstFrameJump(
    const Skeleton& skeleton,
    const Eigen::Ref<const Eigen::MatrixXd>& positions) {
  if (positions.cols() < 3) return std::nullopt;
  Eigen::VectorXd velocity(skeleton.velocity_count());
  const auto turn_after = [&](int frame) {
    Difference(skeleton, positions.col(frame), positions.col(frame + 1),
               velocity);
    return LargestTurn(skeleton, velocity);
  };
  const Turn first = turn_after(0);
  if (first.angle_rad < kMinJumpRad) return std::nullopt;
  std::vector<double> others;
  for (int frame = 1; frame + 1 < positions.cols() && frame <= kTypicalFrames;
       ++frame) {
    others.push_back(turn_after(frame).angle_rad);
  }
  const double typical = Median(std::move(others));
  if (first.angle_rad < kMinJumpRatio * typical) return std::nullopt;
  return FirstFrameJump{first.joint, first.angle_rad, typical};
}

int CountFramesBeforeMotion(
    const Skeleton& skeleton,
    const Eigen::Ref<const Eigen::MatrixXd>& positions) {
  int count = 0;
  while (count < kMaxWayFrames &&
         FindFirstFrameJump(skeleton,
                            positions.rightCols(positions.cols() - count))) {
    ++count;
  }
  return count;
}

}  // namespace gelenk
