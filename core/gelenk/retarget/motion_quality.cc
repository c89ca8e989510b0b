#include "gelenk/retarget/motion_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

// A leg is overstretched beyond this part of its length, ...
constexpr double kMaxExtension = 0.9995;
// ... made from another, when it is this straight and straighter than that.
constexpr double kStraight = 0.995;
constexpr double kStraighter = 0.002;
// A knee that bends this much the wrong way is bent backwards.
const double kBackwardSine = -std::sin(3 * kDegree);

// Differences are over this time, so that the frame rate does not matter.
constexpr double kJerkStep_s = 1.0 / 30;

// Mean third difference of the place of `role`.
double JerkOf(const BodyMotionView& motion, BodyRole role) {
  const int count = static_cast<int>(motion.frames.size());
  const int step = std::max(
      1, static_cast<int>(std::lround(kJerkStep_s / motion.frame_time_s)));
  const double step_s = step * motion.frame_time_s;
  if (count <= 3 * step || !motion.model.map.Has(role)) return 0;
  double sum = 0;
  for (int f = 3 * step; f < count; ++f) {
    const auto at = [&](int back) -> const Vector3d& {
      return motion.frames[f - back * step].position(role);
    };
    sum += (at(0) - 3 * at(1) + 3 * at(2) - at(3)).norm();
  }
  return sum / (count - 3 * step) / (step_s * step_s * step_s);
}

// The length of the bones from the pelvis to `role` at the reference; that of a
// leg for the pelvis itself.
double ReachOf(const BodyModel& model, BodyRole role) {
  const Skeleton& skeleton = *model.skeleton;
  const int pelvis = model.map.joint(BodyRole::kPelvis);
  double way = 0;
  for (int i = model.map.joint(role); i >= 0 && i != pelvis;
       i = skeleton.span(i).parent) {
    way += model.parent_from_joint[i].translation.norm();
  }
  return way > 0 ? way : model.leg_length;
}

// The distance from thigh to foot as a part of the leg.
double Extension(const BodyMotionView& motion, size_t frame, int side) {
  const LegRoles& leg = kLegRoles[side];
  const BodyPose& pose = motion.frames[frame];
  return (pose.position(leg.foot) - pose.position(leg.thigh)).norm() /
         motion.model.legs[side].Total();
}

// Sine of the knee's bend; negative the wrong way.
double KneeSine(const BodyPose& pose, int side) {
  const LegRoles& leg = kLegRoles[side];
  const Vector3d thigh =
      (pose.position(leg.shin) - pose.position(leg.thigh)).stableNormalized();
  const Vector3d shin =
      (pose.position(leg.foot) - pose.position(leg.shin)).stableNormalized();
  return (pose.rotation(leg.thigh).conjugate() * thigh.cross(shin)).x();
}

double TurnOf(const BodyMotionView& motion, size_t frame, BodyRole role) {
  return AngleBetween(motion.frames[frame - 1].rotation(role),
                      motion.frames[frame].rotation(role)) /
         kDegree;
}

double Ratio(double made, double source) {
  constexpr double kNothing = 1e-9;
  if (source > kNothing) return made / source;
  return made > kNothing ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace

FeetGeometry FeetOf(const BodyModel& model) {
  return {model.planted_heights, model.leg_length};
}

std::vector<FootPoints> FootPointsOf(absl::Span<const BodyPose> frames) {
  std::vector<FootPoints> points;
  points.reserve(frames.size());
  for (const BodyPose& pose : frames) points.push_back(pose.foot_points);
  return points;
}

MotionQuality MeasureMotion(const BodyMotionView& motion,
                            const ContactLabels& labels, const Ground* floor) {
  MotionQuality quality;
  const JointMap& map = motion.model.map;
  if (map.HasLegs()) {
    const std::vector<FootPoints> points = FootPointsOf(motion.frames);
    FeetView view = {points, motion.frame_time_s, FeetOf(motion.model)};
    view.ground = floor;
    for (int side : kSides) {
      for (int point = 0; point < kFootPointCount; ++point) {
        view.floor_m[side][point] = labels.floor_m + labels.bias_m[side][point];
      }
    }
    quality.skate = MeasureSkate(view, labels);
    quality.penetration = MeasurePenetration(view);
  }
  for (size_t f = 0; f < motion.frames.size(); ++f) {
    for (int side : kSides) {
      if (!map.HasLeg(side)) continue;
      if (Extension(motion, f, side) > kMaxExtension ||
          KneeSine(motion.frames[f], side) < kBackwardSine) {
        ++quality.hyper_extended_frames;
      }
    }
  }
  int parts = 0;
  for (size_t i = 0; i < kJerkRoles.size(); ++i) {
    if (!map.Has(kJerkRoles[i])) continue;
    quality.part_jerk_m_s3[i] = JerkOf(motion, kJerkRoles[i]);
    quality.jerk_m_s3 += quality.part_jerk_m_s3[i];
    ++parts;
  }
  if (parts > 0) quality.jerk_m_s3 /= parts;
  for (size_t f = 1; f < motion.frames.size(); ++f) {
    for (int i = 0; i < kBodyRoleCount; ++i) {
      const auto role = static_cast<BodyRole>(i);
      if (!map.Has(role)) continue;
      quality.largest_turn_deg =
          std::max(quality.largest_turn_deg, TurnOf(motion, f, role));
    }
  }
  return quality;
}

MotionComparison CompareMotion(const BodyMotionView& source,
                               const MotionQuality& source_quality,
                               const BodyMotionView& made,
                               const MotionQuality& made_quality) {
  MotionComparison comparison;
  const double scale = made.model.leg_length / source.model.leg_length;
  comparison.label_skate_ratio = Ratio(made_quality.skate.label_cm_s,
                                       source_quality.skate.label_cm_s * scale);
  comparison.rule_skate_ratio = Ratio(made_quality.skate.rule_cm_s,
                                      source_quality.skate.rule_cm_s * scale);
  double jerk = 0;
  double source_jerk = 0;
  for (size_t i = 0; i < kJerkRoles.size(); ++i) {
    const BodyRole role = kJerkRoles[i];
    if (!source.model.map.Has(role) || !made.model.map.Has(role)) continue;
    // Parts travel as the legs are longer and turn as their own bones are.
    const double size = std::max(
        scale, ReachOf(made.model, role) / ReachOf(source.model, role));
    jerk += made_quality.part_jerk_m_s3[i];
    source_jerk += size * source_quality.part_jerk_m_s3[i];
  }
  comparison.jerk_ratio = Ratio(jerk, source_jerk);
  for (size_t f = 0; f < made.frames.size(); ++f) {
    for (int side : kSides) {
      if (source.model.map.HasLeg(side) && made.model.map.HasLeg(side)) {
        const double extension = Extension(made, f, side);
        const bool is_stretched =
            extension > kStraight &&
            extension > Extension(source, f, side) + kStraighter;
        const bool is_backward =
            KneeSine(made.frames[f], side) < kBackwardSine &&
            KneeSine(source.frames[f], side) > kBackwardSine / 2;
        if (is_stretched || is_backward) {
          ++comparison.new_hyper_extended_frames;
        }
      }
    }
  }
  for (size_t f = 1; f < made.frames.size(); ++f) {
    for (int i = 0; i < kBodyRoleCount; ++i) {
      const auto role = static_cast<BodyRole>(i);
      if (!made.model.map.Has(role) || !source.model.map.Has(role)) continue;
      comparison.largest_extra_turn_deg =
          std::max(comparison.largest_extra_turn_deg,
                   TurnOf(made, f, role) - TurnOf(source, f, role));
    }
  }
  return comparison;
}

}  // namespace gelenk
