#include "gelenk/skin/section_fit.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/skin/vertex_placement.h"

namespace gelenk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A surface looks away from its bone: below this cosine it does not.
constexpr double kFacingCosine = 0.2;
// Sections reach a little beyond the surface; wider ones take in the
// neighbours'.
constexpr double kSectionMargin = 1.15;
// Of the surface's distances from a bone: where a limb branches off, what comes
// first is another limb's.
constexpr double kSectionQuantile = 0.9;
// A point is another chain's when that is nearer by more than this factor.
constexpr double kOwnFactor = 1.1;
// The section of a bone without flesh, as a part of its length.
constexpr double kBareSection = 0.01;
// Points between the vertices of a coarse mesh are this part of a link apart,
// in the mean: as close as a section is looked at.
constexpr double kSpacingOfLink = 1.0 / 16;
// A triangle is cut into so many parts a side at most, and so many points are
// looked at in all.
constexpr int kMostCuts = 16;
constexpr size_t kMostPoints = size_t{1} << 21;

// A point of a surface and its unit normal.
struct SurfacePoint {
  Vector3d position;
  Vector3d normal;
  // The chain that is nearest, how near, and how near the next one is.
  int chain = -1;
  double distance_m = kInfinity;
  double next_distance_m = kInfinity;
};

double SpacingFor(const VolumeRig& rig) {
  double length_m = 0;
  for (const SkinLink& link : rig.links()) length_m += link.length_m;
  return kSpacingOfLink * length_m / rig.link_count();
}

// The vertices, and points inside triangles that are larger than the spacing:
// the limbs of a coarse mesh have vertices at their ends only.
std::vector<SurfacePoint> PointsOf(const TriangleMesh& mesh, double spacing_m) {
  const std::vector<Vector3d> normals = VertexNormals(mesh);
  std::vector<SurfacePoint> points;
  for (size_t v = 0; v < normals.size(); ++v) {
    points.push_back({mesh.positions[v], normals[v]});
  }
  for (const Triangle& triangle : mesh.triangles) {
    const Vector3d& a = mesh.positions[triangle[0]];
    const Vector3d ab = mesh.positions[triangle[1]] - a;
    const Vector3d ac = mesh.positions[triangle[2]] - a;
    const double longest_m = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    if (longest_m <= spacing_m || points.size() >= kMostPoints) continue;
    const int cuts = static_cast<int>(
        std::min<double>(std::ceil(longest_m / spacing_m), kMostCuts));
    const Vector3d normal = ab.cross(ac).normalized();
    for (int i = 0; i <= cuts; ++i) {
      for (int j = 0; i + j <= cuts; ++j) {
        points.push_back({a + (i * ab + j * ac) / cuts, normal});
      }
    }
  }
  return points;
}

void FindNearestChains(const VolumeRig& rig,
                       std::vector<SurfacePoint>& points) {
  const VertexPlacer placer(rig);
  for (SurfacePoint& point : points) {
    for (int i = 0; i < rig.link_count(); ++i) {
      const double distance_m = placer.DistanceFromBone(point.position, i);
      if (rig.chain(i) == point.chain) {
        point.distance_m = std::min(point.distance_m, distance_m);
      } else if (distance_m < point.distance_m) {
        point.next_distance_m = point.distance_m;
        point.distance_m = distance_m;
        point.chain = rig.chain(i);
      } else {
        point.next_distance_m = std::min(point.next_distance_m, distance_m);
      }
    }
  }
}

class SectionFitter {
 public:
  SectionFitter(const VolumeRig& rig, int link)
      : rotation_(rig.rest().rotation(link)),
        origin_(rig.rest().origin(link)),
        chain_(rig.chain(link)),
        link_(rig.link(link)) {
    first_.fill({kInfinity, false});
    own_.fill({kInfinity, Vector2d::Zero()});
  }

  LinkSection Fit(absl::Span<const SurfacePoint> points) {
    LinkSection section = {link_.half_extents_m, link_.cap_reach_m};
    if (!FindReach(points)) return section;
    for (const SurfacePoint& point : points) Look(point);
    const bool is_bare = link_.continuation >= 0 && 2 * FindFlesh() < kSlices;
    if (is_bare) {
      section.half_extents_m.setConstant(kBareSection * link_.length_m);
    } else {
      FitHalfExtents(section.half_extents_m);
    }
    // Round, or as far as the surface goes.
    section.cap_reach_m = section.half_extents_m.maxCoeff() * Vector2d::Ones();
    section.cap_reach_m = section.cap_reach_m.cwiseMax(
        kSectionMargin * Vector2d(-start_m_, end_m_ - link_.length_m));
    return section;
  }

 private:
  static constexpr int kSlices = 8;
  static constexpr int kDirections = 16;
  static constexpr int kBins = kSlices * kDirections;
  static constexpr int kFewDirections = kBins / 4;

  struct First {
    double distance_m;
    bool faces_away;
  };
  struct Own {
    double distance_m;
    Vector2d across;
  };

  bool IsOwn(const SurfacePoint& point, double distance_m) const {
    const double other_m =
        point.chain == chain_ ? point.next_distance_m : point.distance_m;
    return distance_m <= kOwnFactor * other_m;
  }

  // From where to where along the bone its surface goes. Beyond the bone only
  // where a chain ends, else just there where the bone is.
  bool FindReach(absl::Span<const SurfacePoint> points) {
    start_m_ = 0;
    end_m_ = link_.length_m;
    if (link_.continuation >= 0 && link_.parent >= 0) return true;
    double least_m = kInfinity, most_m = -kInfinity;
    for (const SurfacePoint& point : points) {
      if (point.chain != chain_) continue;
      const Vector3d local = rotation_.transpose() * (point.position - origin_);
      const double past_m =
          local.x() - std::clamp(local.x(), 0.0, link_.length_m);
      const double distance_m = std::hypot(past_m, local.y(), local.z());
      if (distance_m > point.distance_m) continue;
      least_m = std::min(least_m, local.x());
      most_m = std::max(most_m, local.x());
    }
    if (!(most_m > 0)) return false;
    if (link_.parent < 0) start_m_ = std::min(least_m, 0.0);
    if (link_.continuation < 0) end_m_ = most_m;
    return true;
  }

  void Look(const SurfacePoint& point) {
    const Vector3d local = rotation_.transpose() * (point.position - origin_);
    const double along = local.x() / end_m_;
    if (!(along >= 0 && along < 1)) return;
    const Vector2d across = local.tail<2>();
    const double distance_m = across.norm();
    const double turn =
        std::atan2(across[1], across[0]) / (2 * std::numbers::pi) + 0.5;
    const int direction =
        std::min(static_cast<int>(kDirections * turn), kDirections - 1);
    const int bin = kDirections * static_cast<int>(kSlices * along) + direction;
    const Vector2d outwards = (rotation_.transpose() * point.normal).tail<2>();
    const double cosine = outwards.dot(across);
    if (distance_m < first_[bin].distance_m) {
      first_[bin] = {distance_m, cosine >= 0};
    }
    if (cosine < kFacingCosine * distance_m) return;
    const double past_m = std::max(local.x() - link_.length_m, 0.0);
    if (distance_m >= own_[bin].distance_m ||
        !IsOwn(point, std::hypot(distance_m, past_m))) {
      return;
    }
    own_[bin] = {distance_m, across};
  }

  // The slices where the bone is within the surface: what comes first looks
  // away from it. Forgets what was seen from the others.
  int FindFlesh() {
    int inside = 0;
    for (int slice = 0; slice < kSlices; ++slice) {
      int away = 0, towards = 0;
      for (int k = 0; k < kDirections; ++k) {
        const First& first = first_[kDirections * slice + k];
        if (!std::isfinite(first.distance_m)) continue;
        ++(first.faces_away ? away : towards);
      }
      if (away >= towards) {
        ++inside;
        continue;
      }
      for (int k = 0; k < kDirections; ++k) {
        own_[kDirections * slice + k].distance_m = kInfinity;
      }
    }
    return inside;
  }

  void FitHalfExtents(Vector2d& half_extents_m) const {
    std::vector<Vector2d> seen;
    for (const Own& own : own_) {
      if (std::isfinite(own.distance_m)) seen.push_back(own.across);
    }
    if (static_cast<int>(seen.size()) < kFewDirections) return;
    // How flat the section is, then how large: limbs taper.
    Vector2d shape;
    for (int k = 0; k < 2; ++k) {
      shape[k] =
          Quantile(seen, [k](const Vector2d& p) { return std::abs(p[k]); });
    }
    if (!(shape.minCoeff() > 0)) return;
    const double size = Quantile(
        seen, [&](const Vector2d& p) { return p.cwiseQuotient(shape).norm(); });
    half_extents_m = kSectionMargin * size * shape;
  }

  template <typename Measure>
  static double Quantile(const std::vector<Vector2d>& points,
                         const Measure& measure) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Vector2d& point : points) values.push_back(measure(point));
    const auto at =
        values.begin() + static_cast<int>(kSectionQuantile * values.size());
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }

  const Eigen::Matrix3d& rotation_;
  const Vector3d& origin_;
  int chain_;
  const SkinLink& link_;
  double start_m_ = 0;
  double end_m_ = 0;
  // In each slice and direction.
  std::array<First, kBins> first_;  // whatever comes first
  std::array<Own, kBins> own_;      // what may be the limb's
};

}  // namespace

std::shared_ptr<const VolumeRig> FitSections(const VolumeRig& rig,
                                             const TriangleMesh& mesh) {
  std::vector<SurfacePoint> points = PointsOf(mesh, SpacingFor(rig));
  FindNearestChains(rig, points);
  std::vector<LinkSection> sections;
  sections.reserve(rig.link_count());
  for (int i = 0; i < rig.link_count(); ++i) {
    sections.push_back(SectionFitter(rig, i).Fit(points));
  }
  return rig.WithSections(sections);
}

}  // namespace gelenk
