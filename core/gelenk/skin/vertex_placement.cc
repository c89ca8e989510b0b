#include "gelenk/skin/vertex_placement.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A branch has all of what is within its section, nothing of what is beyond
// this many sections: wider would take hold of the other leg.
constexpr double kBlendReach = 1.5;
// A stub gains hold of its vertices over this part of its length, so that its
// parent need not be rigid where it starts.
constexpr double kStubRamp = 1.0 / 3;
// And loses hold of its parent's over this part of its first half.
constexpr double kFlankRamp = 0.6;
// Shares nearer to 1 than this are 1.
constexpr double kWhole = 1e-9;

double Smoothstep(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}
double SmoothstepSlope(double x) {
  return x <= 0 || x >= 1 ? 0 : 6 * x * (1 - x);
}

}  // namespace

VertexPlacer::VertexPlacer(const VolumeRig& rig) : rig_(rig) {
  for (int i = 0; i < rig.link_count(); ++i) {
    if (rig.is_branch(i)) branches_.push_back(i);
  }
}

bool VertexPlacer::InVolume(const Vector3d& point, int volume,
                            Placement* placement) const {
  const BezierVolume& rest = rig_.rest().volume(volume);
  const std::optional<VolumeCoordinates> at = rest.Invert(point);
  if (!at) return false;
  placement->link = rig_.volume_link(volume);
  placement->volume = volume;
  placement->at = *at;
  const Eigen::Vector2d& section = rig_.link(placement->link).half_extents_m;
  placement->radius = std::hypot(at->s / section[0], at->t / section[1]);
  placement->offset_m = point - rest.At(at->u).center();
  return true;
}

// Beyond the end of a chain, where the rigid volume continues it.
bool VertexPlacer::InCap(const Vector3d& point, int link,
                         Placement* placement) const {
  const SkinLink& described = rig_.link(link);
  const Vector3d local = rig_.rest().rotation(link).transpose() *
                         (point - rig_.rest().origin(link));
  const bool before = local.x() < 0 && described.parent < 0;
  const bool beyond =
      local.x() > described.length_m && described.continuation < 0;
  if (!before && !beyond) return false;
  const Eigen::Vector2d& section = described.half_extents_m;
  const double over_m = before ? -local.x() : local.x() - described.length_m;
  const double reach_m = described.cap_reach_m[before ? 0 : 1];
  placement->link = link;
  placement->volume = rig_.volume(link, VolumePart::kRigid);
  placement->at = {local.x() / described.length_m, local.y(), local.z()};
  placement->radius =
      std::max(over_m / reach_m,
               std::hypot(local.y() / section[0], local.z() / section[1]));
  // The bone of a long cap goes on to where its round end begins.
  const double past_m =
      std::clamp(over_m - reach_m + section.maxCoeff(), 0.0, over_m);
  placement->offset_m =
      rig_.rest().rotation(link) *
      Vector3d(before ? -past_m : past_m, local.y(), local.z());
  return true;
}

bool VertexPlacer::BestInLink(const Vector3d& point, int link,
                              Placement* placement) const {
  bool found = false;
  const auto offer = [&](const Placement& other) {
    if (!found || other.radius < placement->radius) *placement = other;
    found = true;
  };
  Placement other;
  for (VolumePart part : {VolumePart::kFirstHalf, VolumePart::kSecondHalf}) {
    if (InVolume(point, rig_.volume(link, part), &other)) offer(other);
  }
  if (rig_.is_branch(link) &&
      InVolume(point, rig_.volume(link, VolumePart::kStub), &other)) {
    offer(other);
  }
  if (InCap(point, link, &other)) offer(other);
  return found;
}

double VertexPlacer::DistanceFromBone(const Vector3d& point, int link) const {
  const Vector3d offset = point - rig_.rest().origin(link);
  const Vector3d axis = rig_.rest().rotation(link).col(0);
  const double along =
      std::clamp(offset.dot(axis), 0.0, rig_.link(link).length_m);
  return (offset - along * axis).norm();
}

int VertexPlacer::NearestLink(const Vector3d& point) const {
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < rig_.link_count(); ++i) {
    const double distance = DistanceFromBone(point, i);
    if (distance < least) best = i, least = distance;
  }
  return best;
}

void VertexPlacer::FindNear(const Vector3d& point, double reach,
                            std::vector<Placement>& placements) const {
  placements.clear();
  for (int i = 0; i < rig_.link_count(); ++i) {
    if (DistanceFromBone(point, i) > reach * Slack(i)) continue;
    Placement placement;
    if (BestInLink(point, i, &placement) && placement.radius <= reach) {
      placements.push_back(placement);
    }
  }
}

Placement VertexPlacer::InChain(const Vector3d& point, int chain) const {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < rig_.link_count(); ++i) {
    if (rig_.chain(i) != chain) continue;
    const double distance = DistanceFromBone(point, i);
    if (distance < least) nearest = i, least = distance;
  }
  // Inverting volumes is dear: first those of links that are about as near.
  for (bool only_near : {true, false}) {
    Placement best;
    for (int i = 0; i < rig_.link_count(); ++i) {
      if (rig_.chain(i) != chain) continue;
      if (only_near && DistanceFromBone(point, i) > least + Slack(i)) continue;
      Placement placement;
      if (BestInLink(point, i, &placement) &&
          (best.link < 0 || placement.radius < best.radius)) {
        best = placement;
      }
    }
    if (best.link >= 0) return best;
  }
  return InLink(point, nearest);
}

// By how much a link may be farther than another and still hold a point: its
// stub lies before the bone, its bent volumes beside it, its caps at the ends.
double VertexPlacer::Slack(int link) const {
  const double section = std::max(2 * rig_.link(link).half_extents_m.maxCoeff(),
                                  rig_.link(link).cap_reach_m.maxCoeff());
  return rig_.is_branch(link) ? section + 3 * rig_.start_spacing_m(link)
                              : section;
}

Placement VertexPlacer::InLink(const Vector3d& point, int link) const {
  Placement placement;
  for (VolumePart part : {VolumePart::kFirstHalf, VolumePart::kSecondHalf}) {
    if (InVolume(point, rig_.volume(link, part), &placement)) return placement;
  }
  const Vector3d local = rig_.rest().rotation(link).transpose() *
                         (point - rig_.rest().origin(link));
  placement.link = link;
  placement.volume = rig_.volume(link, VolumePart::kRigid);
  placement.at = {local.x() / rig_.link(link).length_m, local.y(), local.z()};
  return placement;
}

void VertexPlacer::AddShares(const Vector3d& point, Placement& placement,
                             std::vector<BlendShare>& shares) const {
  // What is in a stub is its parent's, too; that may be a branch itself.
  std::vector<int> core_chains = {rig_.chain(placement.link)};
  if (rig_.volume_part(placement.volume) == VolumePart::kStub) {
    core_chains.clear();
  }
  while (rig_.volume_part(placement.volume) == VolumePart::kStub) {
    core_chains.push_back(rig_.chain(rig_.link(placement.link).parent));
    placement = InChain(point, core_chains.back());
  }
  const auto is_of_core = [&](int branch) {
    const int chain = rig_.chain(rig_.link(branch).parent);
    return std::find(core_chains.begin(), core_chains.end(), chain) !=
           core_chains.end();
  };
  const size_t first = shares.size();
  for (int branch : branches_) {
    if (!is_of_core(branch)) continue;
    Placement in_branch;
    const bool behind =
        InVolume(point, rig_.volume(branch, VolumePart::kStub), &in_branch);
    if (!behind && !InVolume(point, rig_.volume(branch, VolumePart::kFirstHalf),
                             &in_branch)) {
      continue;
    }
    // What is bound to the parent but lies beyond the branch's joint follows
    // the branch a little way on: farther, it is the flank that an arm hangs
    // by.
    const double u = in_branch.at.u;
    const double length = behind ? kStubRamp : kFlankRamp;
    const double ramp =
        behind ? Smoothstep(u / length) : 1 - Smoothstep(u / length);
    const double ramp_slope =
        (behind ? 1 : -1) * SmoothstepSlope(u / length) / length;
    const double x = (kBlendReach - in_branch.radius) / (kBlendReach - 1);
    BlendShare share;
    share.volume = in_branch.volume;
    share.at = in_branch.at;
    share.share = ramp * Smoothstep(x);
    if (share.share <= 0) continue;
    const Matrix3d coordinates_from_point = rig_.rest()
                                                .volume(share.volume)
                                                .Evaluate(share.at)
                                                .Jacobian()
                                                .inverse();
    const Eigen::Vector2d& section = rig_.link(branch).half_extents_m;
    Vector3d slope(ramp_slope * Smoothstep(x), 0, 0);
    if (in_branch.radius > 0) {
      const double radial =
          -ramp * SmoothstepSlope(x) / (kBlendReach - 1) / in_branch.radius;
      slope[1] = radial * share.at.s / (section[0] * section[0]);
      slope[2] = radial * share.at.t / (section[1] * section[1]);
    }
    share.gradient = coordinates_from_point.transpose() * slope;
    shares.push_back(share);
  }
  if (shares.size() == first) return;

  // Several branches: shares as odds against the parent, w / (1 - w), so that
  // each has all of what is within its own section.
  const auto whole =
      std::find_if(shares.begin() + first, shares.end(),
                   [](const BlendShare& s) { return s.share > 1 - kWhole; });
  if (whole != shares.end()) {
    placement.link = rig_.volume_link(whole->volume);
    placement.volume = whole->volume;
    placement.at = whole->at;
    shares.resize(first);
    return;
  }
  if (shares.size() == first + 1) return;
  double sum = 1;
  Vector3d sum_gradient = Vector3d::Zero();
  for (size_t i = first; i < shares.size(); ++i) {
    BlendShare& share = shares[i];
    share.gradient /= (1 - share.share) * (1 - share.share);
    share.share /= 1 - share.share;
    sum += share.share;
    sum_gradient += share.gradient;
  }
  for (size_t i = first; i < shares.size(); ++i) {
    BlendShare& share = shares[i];
    share.share /= sum;
    share.gradient = (share.gradient - share.share * sum_gradient) / sum;
  }
}

}  // namespace gelenk
