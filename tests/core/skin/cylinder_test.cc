// A closed cylinder around two links, bent and twisted, by every kind of skin:
// what of its volume and of its bore is left. Reference values of an
// independent prototype.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/mesh_around.h"
#include "gelenk/skin/weighted_skin.h"
#include "tests/core/skin/mesh_checks.h"
#include "tests/core/skin/skin_chains.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;
using ::gelenk::testing::ElbowAt;
using ::gelenk::testing::PositionsOf;
using ::gelenk::testing::TwoLinkArm;

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.2;
constexpr int kRings = 240;
constexpr int kAround = 96;
// In points of a percent of the volume, and of the radius.
constexpr double kVolumeTolerance = 0.1;
constexpr double kLinearBlendTolerance = 0.2;
constexpr double kRadiusTolerance = 0.002;

TriangleMesh Cylinder() {
  TubeShape shape;
  shape.length_m = 2;
  shape.radius_m = kRadius;
  shape.rings = kRings;
  shape.around = kAround;
  return TubeMesh(shape).value();
}

struct Measure {
  double volume_change_percent;
  double smallest_ring;  // radius against that at rest
};

Measure MeasureOf(const Skin& skin, double angle_rad) {
  SkinWorkspace workspace;
  VertexBlocks blocks;
  const auto at = [&](double angle) {
    skin.Deform(ElbowAt(skin.skeleton(), angle), {}, workspace, blocks);
    return PositionsOf(skin, blocks);
  };
  const double at_rest = EnclosedVolume(at(0), skin.triangles());
  const std::vector<Vector3d> bent = at(angle_rad);
  double smallest = HUGE_VAL;
  for (int ring = 0; ring <= kRings; ++ring) {
    Vector3d center = Vector3d::Zero();
    for (int i = 0; i < kAround; ++i) center += bent[ring * kAround + i];
    center /= kAround;
    Vector3d area = Vector3d::Zero();
    for (int i = 0; i < kAround; ++i) {
      area +=
          0.5 * (bent[ring * kAround + i] - center)
                    .cross(bent[ring * kAround + (i + 1) % kAround] - center);
    }
    smallest = std::min(smallest, std::sqrt(area.norm() / kPi) / kRadius);
  }
  return {100 * (EnclosedVolume(bent, skin.triangles()) / at_rest - 1),
          smallest};
}

std::shared_ptr<const Skin> Layered(const Vector3d& axis,
                                    const SkinMuscles& muscles = {}) {
  const auto rig = VolumeRig::Create(TwoLinkArm(axis), {}, muscles).value();
  return LayeredSkin::Bind(*rig, Cylinder()).value();
}

SkinMuscles VolumeMuscles() {
  SkinMuscles muscles;
  for (const char* link : {"upper", "lower"}) {
    Muscle muscle;
    muscle.id = muscle.link_id = link;
    muscle.mode = MuscleMode::kPreserveVolume;
    muscles.muscles.push_back(muscle);
  }
  return muscles;
}

// Weights that change over the same length as the volumes do: smoothstep over
// half a link on either side of the joint.
std::shared_ptr<const Skin> Weighted(const Vector3d& axis, BlendMethod method) {
  const TriangleMesh mesh = Cylinder();
  SkinWeights weights;
  weights.influences_per_vertex = 2;
  for (const Vector3d& position : mesh.positions) {
    const double x = std::clamp(position.x() - 0.5, 0.0, 1.0);
    const double lower = x * x * (3 - 2 * x);
    weights.joints.insert(weights.joints.end(), {0, 1});
    weights.weights.insert(weights.weights.end(), {1 - lower, lower});
  }
  WeightedSkin::Options options;
  options.method = method;
  return WeightedSkin::Create(TwoLinkArm(axis), mesh, weights, options).value();
}

void ExpectMeasure(const Skin& skin, double angle_rad, double percent,
                   double ring, double volume_tolerance = kVolumeTolerance) {
  const Measure measure = MeasureOf(skin, angle_rad);
  EXPECT_NEAR(measure.volume_change_percent, percent, volume_tolerance);
  EXPECT_NEAR(measure.smallest_ring, ring, kRadiusTolerance);
}

TEST(CylinderTest, BentByNinetyDegrees) {
  const Vector3d axis = Vector3d::UnitZ();
  const double bend = kPi / 2;
  ExpectMeasure(*Weighted(axis, BlendMethod::kLinear), bend, -6.43, 0.841,
                kLinearBlendTolerance);
  ExpectMeasure(*Weighted(axis, BlendMethod::kDualQuaternion), bend, -0.01, 1);
  ExpectMeasure(*Layered(axis), bend, -4.39, 0.961);
  ExpectMeasure(*Layered(axis, VolumeMuscles()), bend, 0, 0.979);
}

// Dual quaternions turn either way at half a turn: a hair less than that.
TEST(CylinderTest, TwistedByHalfATurn) {
  const Vector3d axis = Vector3d::UnitX();
  const double twist = kPi - 1e-4;
  ExpectMeasure(*Weighted(axis, BlendMethod::kLinear), twist, -25.7, 0,
                kLinearBlendTolerance);
  ExpectMeasure(*Weighted(axis, BlendMethod::kDualQuaternion), twist, -0.03, 1);
  ExpectMeasure(*Layered(axis), twist, -12.9, 0.707);
  ExpectMeasure(*Layered(axis, VolumeMuscles()), twist, 0, 0.751);
}

}  // namespace
}  // namespace gelenk
