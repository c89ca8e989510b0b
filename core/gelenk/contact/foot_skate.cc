#include "gelenk/contact/foot_skate.h"

#include <algorithm>
#include <cmath>

namespace gelenk {
namespace {

constexpr double kCmPerM = 100;

struct Mean {
  double sum = 0;
  double count = 0;

  void Add(double value) {
    sum += value;
    ++count;
  }
  double Value() const { return count > 0 ? sum / count : 0; }
};

double FloorUnder(const FeetView& view, const Eigen::Vector3d& at, int side,
                  int point) {
  return view.ground != nullptr ? view.ground->HeightAt(at)
                                : view.floor_m[side][point];
}

double HeightOf(const FeetView& view, size_t frame, int side, int point) {
  const Eigen::Vector3d& at = view.frames[frame][side][point];
  return at.y() - view.feet.planted_heights[side][point] -
         FloorUnder(view, at, side, point);
}

}  // namespace

FootSkate MeasureSkate(const FeetView& view, const ContactLabels& labels) {
  const double size = view.feet.leg_length_m / kReferenceLegM;
  Mean planted;
  Mean in_contact;
  Mean weighted;
  Mean rule;
  double slid_m = 0;
  double standing_s = 0;
  for (size_t f = 1; f < view.frames.size(); ++f) {
    for (int side = 0; side < 2; ++side) {
      double foot_slid_m = 0;
      int foot_planted = 0;
      for (int point : {kHeel, kBall}) {
        const Eigen::Vector3d step =
            view.frames[f][side][point] - view.frames[f - 1][side][point];
        const double way = Horizontal(step).norm();
        const double speed = way / view.frame_time_s;
        const Contact before = labels.frames[f - 1][side][point];
        const Contact now = labels.frames[f][side][point];
        if (before != Contact::kNone && now != Contact::kNone) {
          in_contact.Add(speed);
          if (before == Contact::kPlanted && now == Contact::kPlanted) {
            planted.Add(speed);
            foot_slid_m += way;
            ++foot_planted;
          }
        }
        const double height = HeightOf(view, f, side, point);
        const double higher =
            std::max(height, HeightOf(view, f - 1, side, point));
        const double top = kWeightedSkateHeight * size;
        if (height < top) {
          weighted.Add(speed * (2 - std::exp2(std::max(height, 0.0) / top)));
        }
        if (higher < kRuleMaxHeight * size &&
            step.norm() / view.frame_time_s < kRuleMaxSpeed * size) {
          rule.Add(speed);
        }
      }
      if (foot_planted == 0) continue;
      slid_m += foot_slid_m / foot_planted;
      standing_s += view.frame_time_s;
    }
  }
  FootSkate skate;
  skate.label_cm_s = kCmPerM * planted.Value();
  skate.label_with_turning_cm_s = kCmPerM * in_contact.Value();
  skate.weighted_cm_s = kCmPerM * weighted.Value();
  skate.rule_cm_s = kCmPerM * rule.Value();
  skate.m_per_contact_s = standing_s > 0 ? slid_m / standing_s : 0;
  skate.contact_ratio = labels.ContactRatio();
  return skate;
}

Penetration MeasurePenetration(const FeetView& view) {
  Penetration penetration;
  Mean depth;
  for (size_t f = 0; f < view.frames.size(); ++f) {
    for (int side = 0; side < 2; ++side) {
      for (int point = 0; point < kFootPointCount; ++point) {
        const double below = std::max(0.0, -HeightOf(view, f, side, point));
        penetration.max_m = std::max(penetration.max_m, below);
        depth.Add(below);
      }
    }
  }
  penetration.mean_m = depth.Value();
  return penetration;
}

}  // namespace gelenk
