#include "gelenk/formats/bvh_body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/motion/body_height.h"
#include "gelenk/motion/body_parts.h"

namespace gelenk {
namespace {

struct Unit {
  absl::string_view name;
  double length_m;
  // Too rare to be guessed from less than a body.
  bool bodies_only;
};

constexpr std::array<Unit, 6> kUnits = {{{"1 m", 1, false},
                                         {"1 cm", 0.01, false},
                                         {"1 mm", 0.001, false},
                                         {"1 inch", 0.0254, true},
                                         {"1 foot", 0.3048, true},
                                         {"CMU's 5.6444 cm", 0.056444, true}}};

constexpr double kTypicalHeight = 1.7;
// People from toddler to giant: a unit that makes a taller or smaller body is
// taken only when none fits.
constexpr double kMinHeight = 0.6;
constexpr double kMaxHeight = 2.3;

struct Height {
  double units = 0;
  bool is_body = false;
};

// Of the points and, where they are above it, the ground.
double LargestExtent(const WorldTransforms& world_from_joints,
                     const Skeleton& skeleton) {
  Eigen::Vector3d low = world_from_joints[0].translation;
  Eigen::Vector3d high = low;
  const auto include = [&](const Eigen::Vector3d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  };
  for (const RigidTransform& world_from_joint : world_from_joints) {
    include(world_from_joint.translation);
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    include(world_from_joints[skeleton.FindJoint(effector.joint_id)] *
            effector.joint_from_end_effector.translation);
  }
  return std::max((high - low).maxCoeff(), high.y());
}

Height HeightOf(const BvhDocument& document, const Skeleton& skeleton,
                const BvhMapping& mapping) {
  if (const auto body = BodyHeight(skeleton, FindBodyParts(skeleton))) {
    return {*body, true};
  }
  Eigen::VectorXd positions = skeleton.rest_positions();
  if (document.frame_count() > 0) {
    PoseFromChannels(mapping, document.motion.col(0), positions);
  }
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, positions, world_from_joints);
  return {LargestExtent(world_from_joints, skeleton), false};
}

// How far a height is from that of people; more than any fitting one when it
// does not fit.
double Strangeness(double height_m) {
  const double fits =
      height_m >= kMinHeight && height_m <= kMaxHeight ? 0 : 100;
  return fits + std::abs(std::log(height_m / kTypicalHeight));
}

constexpr int kMaxSampledFrames = 64;
// Mean of the unit vector from feet to head along the best axis: 1 stands
// still, upright people who dance or fight stay above 0.8.
constexpr double kClearlyUp = 0.5;

std::string AxisName(int axis, double sign) {
  return absl::StrCat(sign < 0 ? "-" : "+",
                      absl::string_view("XYZ").substr(axis, 1));
}

Eigen::Vector3d MeanDirectionToHead(const BvhDocument& document,
                                    const Skeleton& skeleton,
                                    const BvhMapping& mapping,
                                    const BodyParts& parts) {
  Eigen::VectorXd positions = skeleton.rest_positions();
  WorldTransforms world_from_joints;
  const auto at = [&](int joint) -> Eigen::Vector3d {
    return world_from_joints[joint].translation;
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const int count = std::min(document.frame_count(), kMaxSampledFrames);
  for (int i = 0; i < count; ++i) {
    const int64_t frame = int64_t{i} * document.frame_count() / count;
    PoseFromChannels(mapping, document.motion.col(frame), positions);
    ForwardKinematics(skeleton, positions, world_from_joints);
    const Eigen::Vector3d feet =
        (at(parts.left_foot) + at(parts.right_foot)) / 2;
    sum += (at(parts.head) - feet).stableNormalized();
  }
  return sum / std::max(count, 1);
}

}  // namespace

UnitGuess GuessUnit(const BvhDocument& document, const Skeleton& skeleton,
                    const BvhMapping& mapping) {
  const Height height = HeightOf(document, skeleton, mapping);
  if (!(height.units > 0)) {
    return {0.01, "the skeleton has no extent: its unit is taken as 1 cm"};
  }
  const Unit* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Unit& unit : kUnits) {
    if (unit.bodies_only && !height.is_body) continue;
    const double strangeness = Strangeness(height.units * unit.length_m);
    if (strangeness >= least) continue;
    least = strangeness;
    best = &unit;
  }
  const double height_m = height.units * best->length_m;
  return {best->length_m,
          absl::StrFormat("the file's unit is taken as %s: %s is then %.2f m "
                          "%s",
                          best->name, height.is_body ? "the body" : "it",
                          height_m, height.is_body ? "tall" : "large")};
}

UpGuess GuessUp(const BvhDocument& document, const Skeleton& skeleton,
                const BvhMapping& mapping) {
  UpGuess guess;
  if (document.frame_count() == 0) return guess;
  const BodyParts parts = FindBodyParts(skeleton);
  if (!parts.IsComplete()) return guess;
  const Eigen::Vector3d mean =
      MeanDirectionToHead(document, skeleton, mapping, parts);
  int axis = 1;
  const double height = mean.cwiseAbs().maxCoeff(&axis);
  const double sign = mean[axis] < 0 ? -1 : 1;
  if (height < kClearlyUp) {
    guess.reason = "up is taken as +Y: the head is not clearly above the feet";
    return guess;
  }
  guess.up = sign * Eigen::Vector3d::Unit(axis);
  if (axis == 1 && sign > 0) return guess;
  guess.reason = absl::StrFormat(
      "up is %s: along it the head is above the feet", AxisName(axis, sign));
  return guess;
}

}  // namespace gelenk
