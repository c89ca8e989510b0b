#include "gelenk/retarget/clip_anatomy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "absl/strings/str_format.h"
#include "gelenk/contact/foot_points.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kMaxSampledFrames = 400;
// A hinge is told by frames that bend by more than 20 degrees, ...
const double kMinBendSine = std::sin(20 * kDegree);
// ... by bends of this sum of sines at least, ...
constexpr double kMinBendWeight = 5;
// ... and when so much of them is about one axis.
constexpr double kMinAgreement = 0.5;

// A foot at rest: slower than this, m/s, for this long, ...
constexpr double kRestSpeed = 0.15;
constexpr double kSampleTime_s = 0.033;
constexpr double kMinRestTime_s = 0.2;
// ... and lower than the 30 % lowest ankles plus this, m.
constexpr double kLowQuantile = 0.3;
constexpr double kLowMargin = 0.05;
constexpr int kMinRestSamples = 4;
// Feet lean inwards in a wide stance: half of it is the rig's.
constexpr double kSidewaysPart = 0.5;
// A larger tilt is a foot on its toes.
const double kMinFootLevel = std::cos(41 * kDegree);
const double kMinToeLevel = std::cos(53 * kDegree);

double Quantile(std::vector<double> values, double part) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(
                           part * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

struct Hinge {
  BodyRole upper, lower, end;
  // Canonical: about which it bends, and along the bone.
  Eigen::Vector3d axis;
  Eigen::Vector3d bone;
};

std::vector<Hinge> HingesOf(const JointMap& map) {
  std::vector<Hinge> hinges;
  for (int side : kSides) {
    const ArmRoles& arm = kArmRoles[side];
    const LegRoles& leg = kLegRoles[side];
    const double sign = side == kLeft ? 1 : -1;
    if (map.HasArm(side)) {
      hinges.push_back({arm.upper_arm, arm.forearm, arm.hand,
                        -sign * Eigen::Vector3d::UnitY(),
                        Eigen::Vector3d::UnitX()});
    }
    if (map.HasLeg(side)) {
      hinges.push_back({leg.thigh, leg.shin, leg.foot, Eigen::Vector3d::UnitX(),
                        Eigen::Vector3d::UnitY()});
    }
  }
  return hinges;
}

// The bends of one hinge over a clip, in the anatomical frames of both bones.
struct Bends {
  Eigen::Vector3d upper = Eigen::Vector3d::Zero();
  Eigen::Vector3d lower = Eigen::Vector3d::Zero();
  double weight = 0;
};

// The angle about `bone` that turns `from` to `to`, both made perpendicular.
double RollBetween(const Eigen::Vector3d& bone, const Eigen::Vector3d& from,
                   const Eigen::Vector3d& to) {
  return std::atan2(bone.dot(from.cross(to)), from.dot(to));
}

// A pose of the clip, sampled.
class SampledClip {
 public:
  SampledClip(const Skeleton& skeleton, const ClipView& clip)
      : skeleton_(skeleton), clip_(clip) {}

  void Go(int frame) {
    ForwardKinematics(skeleton_, clip_.positions.col(frame),
                      world_from_joints_);
  }
  const RigidTransform& At(int joint) const {
    return world_from_joints_[joint];
  }

 private:
  const Skeleton& skeleton_;
  const ClipView& clip_;
  WorldTransforms world_from_joints_;
};

// The up of the world in the anatomical frames of one foot and its toes, when
// the foot was at rest, and how high the ankle was.
struct RestingFoot {
  std::vector<Eigen::Vector3d> foot_up;
  std::vector<Eigen::Vector3d> toe_up;
  std::vector<double> height;
};

std::optional<Eigen::Vector3d> MedianUp(const std::vector<Eigen::Vector3d>& ups,
                                        const std::vector<double>& heights,
                                        double max_height) {
  std::array<std::vector<double>, 3> parts;
  for (size_t i = 0; i < ups.size(); ++i) {
    if (heights[i] >= max_height) continue;
    for (int k = 0; k < 3; ++k) parts[k].push_back(ups[i][k]);
  }
  if (parts[0].size() < 3) return std::nullopt;
  Eigen::Vector3d up(Quantile(parts[0], 0.5), Quantile(parts[1], 0.5),
                     Quantile(parts[2], 0.5));
  up.x() *= kSidewaysPart;
  return up.normalized();
}

}  // namespace

std::vector<std::string> AlignHinges(const Skeleton& skeleton,
                                     const JointMap& map, const ClipView& clip,
                                     std::vector<Eigen::Quaterniond>& anatomy) {
  const std::vector<Hinge> hinges = HingesOf(map);
  std::vector<Bends> bends(hinges.size());
  SampledClip body(skeleton, clip);
  const int count = clip.frame_count();
  for (int frame = clip.first_frame; frame < count;
       frame += std::max(1, count / kMaxSampledFrames)) {
    body.Go(frame);
    for (size_t i = 0; i < hinges.size(); ++i) {
      const int upper = map.joint(hinges[i].upper);
      const int lower = map.joint(hinges[i].lower);
      const int end = map.joint(hinges[i].end);
      const Eigen::Vector3d u =
          (body.At(lower).translation - body.At(upper).translation)
              .stableNormalized();
      const Eigen::Vector3d v =
          (body.At(end).translation - body.At(lower).translation)
              .stableNormalized();
      const Eigen::Vector3d normal = u.cross(v);
      if (normal.norm() < kMinBendSine) continue;
      bends[i].upper +=
          anatomy[upper] * (body.At(upper).rotation.conjugate() * normal);
      bends[i].lower +=
          anatomy[lower] * (body.At(lower).rotation.conjugate() * normal);
      bends[i].weight += normal.norm();
    }
  }

  std::vector<std::string> notes;
  for (size_t i = 0; i < hinges.size(); ++i) {
    const Hinge& hinge = hinges[i];
    if (bends[i].weight < kMinBendWeight) continue;
    for (BodyRole role : {hinge.upper, hinge.lower}) {
      Eigen::Vector3d normal =
          role == hinge.upper ? bends[i].upper : bends[i].lower;
      normal -= normal.dot(hinge.bone) * hinge.bone;
      if (normal.norm() < kMinAgreement * bends[i].weight) {
        notes.push_back(absl::StrFormat("%s bends about no single axis",
                                        BodyRoleName(role)));
        continue;
      }
      const double roll =
          RollBetween(hinge.bone, normal.normalized(), hinge.axis);
      const Eigen::Quaterniond turn(Eigen::AngleAxisd(roll, hinge.bone));
      anatomy[map.joint(role)] = turn * anatomy[map.joint(role)];
      // The hand follows the forearm; a foot is turned by its own shape.
      const bool is_arm = hinge.bone.x() != 0;
      if (role == hinge.lower && is_arm) {
        anatomy[map.joint(hinge.end)] = turn * anatomy[map.joint(hinge.end)];
      }
      notes.push_back(absl::StrFormat("%s rolled by %.0f degrees by its hinge",
                                      BodyRoleName(role), roll / kDegree));
    }
  }
  return notes;
}

std::vector<std::string> LevelFeet(
    const Skeleton& skeleton, const JointMap& map, const ClipView& clip,
    const std::array<Eigen::Vector3d, 2>& foot_from_ball, double leg_length,
    double min_tilt_rad, std::vector<Eigen::Quaterniond>& anatomy) {
  std::vector<std::string> notes;
  const double size = leg_length / kReferenceLegM;
  const int step = std::max(
      1, static_cast<int>(std::lround(kSampleTime_s / clip.frame_time_s)));
  const double step_s = step * clip.frame_time_s;
  const Eigen::Vector3d& up = skeleton.up();
  SampledClip body(skeleton, clip);
  for (int side : kSides) {
    if (!map.HasLeg(side)) continue;
    const int foot = map.joint(kLegRoles[side].foot);
    const int toe = map.joint(kLegRoles[side].toe);
    RestingFoot resting;
    Eigen::Vector3d last_ankle = Eigen::Vector3d::Zero();
    Eigen::Vector3d last_ball = Eigen::Vector3d::Zero();
    for (int frame = clip.first_frame; frame < clip.frame_count();
         frame += step) {
      body.Go(frame);
      const Eigen::Vector3d ankle = body.At(foot).translation;
      const Eigen::Vector3d ball = body.At(foot) * foot_from_ball[side];
      if (frame > clip.first_frame) {
        const double way =
            std::max((ankle - last_ankle).norm(), (ball - last_ball).norm());
        if (way < kRestSpeed * size * step_s) {
          resting.foot_up.push_back(anatomy[foot] *
                                    (body.At(foot).rotation.conjugate() * up));
          if (toe >= 0) {
            resting.toe_up.push_back(anatomy[toe] *
                                     (body.At(toe).rotation.conjugate() * up));
          }
          resting.height.push_back(up.dot(ankle));
        }
      }
      last_ankle = ankle;
      last_ball = ball;
    }
    const auto samples = resting.height.size();
    if (samples < kMinRestSamples ||
        static_cast<double>(samples) * step_s < kMinRestTime_s) {
      continue;
    }
    const double max_height =
        Quantile(resting.height, kLowQuantile) + kLowMargin * size;
    const auto level = [&](int joint, BodyRole role,
                           const std::vector<Eigen::Vector3d>& ups,
                           double min_level) {
      const std::optional<Eigen::Vector3d> tilted =
          MedianUp(ups, resting.height, max_height);
      if (!tilted || tilted->y() < min_level) return;
      if (tilted->y() > std::cos(min_tilt_rad)) return;
      anatomy[joint] =
          ShortestRotation(*tilted, Eigen::Vector3d::UnitY()) * anatomy[joint];
      notes.push_back(absl::StrFormat(
          "%s tilted by %.0f degrees to be flat", BodyRoleName(role),
          std::acos(std::min(1.0, tilted->y())) / kDegree));
    };
    level(foot, kLegRoles[side].foot, resting.foot_up, kMinFootLevel);
    if (toe >= 0) {
      level(toe, kLegRoles[side].toe, resting.toe_up, kMinToeLevel);
    }
  }
  return notes;
}

}  // namespace gelenk
