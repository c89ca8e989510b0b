#include "gelenk/skin/bezier_volume.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "gelenk/skin/control_net.h"
#include "tests/core/skin/skin_chains.h"

namespace gelenk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using ::gelenk::testing::BallChain;
using ::gelenk::testing::BentPose;
using ::gelenk::testing::Random;
using ::gelenk::testing::RandomDirection;
using ::gelenk::testing::RandomLengths;
using ::gelenk::testing::RandomMuscles;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::Uniform;

// Some thirty operations on numbers of a few metres.
constexpr double kRounding = 1e-13;

// Both halves of each link of random bent chains with muscles; `planes` are
// the four of each.
struct RandomVolumes {
  std::vector<std::vector<ControlPlane>> planes;
  std::vector<BezierVolume> volumes;

  explicit RandomVolumes(Random& random, double bend_rad = 2.5) {
    for (int chain = 0; chain < 20; ++chain) {
      const auto skeleton = BallChain(random, RandomLengths(random, 4), 1);
      const auto rig =
          VolumeRig::Create(skeleton, {}, RandomMuscles(random, *skeleton))
              .value();
      VolumeFrame frame;
      rig->Evaluate(BentPose(random, *skeleton, bend_rad), {}, frame);
      for (int i = 0; i < rig->link_count(); ++i) {
        for (int half = 0; half < 2; ++half) {
          const auto four = frame.planes(i).subspan(3 * half, 4);
          planes.emplace_back(four.begin(), four.end());
          volumes.push_back(frame.volume(
              rig->volume(i, half == 0 ? VolumePart::kFirstHalf
                                       : VolumePart::kSecondHalf)));
        }
      }
    }
  }
};

VolumeCoordinates RandomCoordinates(Random& random, double size_m) {
  return {Uniform(random, 0, 1), Uniform(random, -size_m, size_m),
          Uniform(random, -size_m, size_m)};
}

TEST(BezierVolumeTest, IsTheSumOfSixtyFourControlPoints) {
  Random random(1);
  const RandomVolumes random_volumes(random);
  const Vector2d half_extents(0.4, 0.3);
  for (size_t i = 0; i < random_volumes.volumes.size(); ++i) {
    std::vector<ControlNet> nets;
    for (const ControlPlane& plane : random_volumes.planes[i]) {
      nets.push_back(UniformNet(plane, half_extents));
    }
    const VolumeCoordinates at = RandomCoordinates(random, 0.3);
    EXPECT_LE((random_volumes.volumes[i].Position(at) -
               SumOfControlPoints(nets, half_extents, at))
                  .norm(),
              kRounding);
  }
}

TEST(BezierVolumeTest, DerivativesAreThoseOfTheMap) {
  Random random(2);
  const RandomVolumes random_volumes(random);
  constexpr double kStep = 1e-6;
  for (const BezierVolume& volume : random_volumes.volumes) {
    const VolumeCoordinates at = RandomCoordinates(random, 0.3);
    const Eigen::Matrix3d jacobian = volume.Evaluate(at).Jacobian();
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = kStep * Vector3d::Unit(k);
      const Vector3d difference =
          (volume.Position({at.u + step[0], at.s + step[1], at.t + step[2]}) -
           volume.Position({at.u - step[0], at.s - step[1], at.t - step[2]})) /
          (2 * kStep);
      // Central differences: step^2 of curvature, rounding over step.
      EXPECT_LE((difference - jacobian.col(k)).norm(), 1e-8);
    }
  }
}

TEST(BezierVolumeTest, InversionIsExact) {
  Random random(3);
  int points = 0;
  for (int chain = 0; chain < 300; ++chain) {
    const auto skeleton = BallChain(random, RandomLengths(random, 4), 1);
    const auto rig = VolumeRig::Create(skeleton).value();
    for (const BezierVolume& volume : rig->rest().volumes()) {
      for (int k = 0; k < 10; ++k, ++points) {
        const VolumeCoordinates at = RandomCoordinates(random, 0.1);
        const auto found = volume.Invert(volume.Position(at));
        ASSERT_TRUE(found.has_value());
        EXPECT_NEAR(found->u, at.u, 1e-13);
        EXPECT_NEAR(found->s, at.s, kRounding);
        EXPECT_NEAR(found->t, at.t, kRounding);
      }
    }
  }
  EXPECT_EQ(points, 36000);
}

TEST(BezierVolumeTest, InversionOfAPointOnEitherEndPlane) {
  Random random(4);
  const RandomVolumes random_volumes(random, 1);
  for (const BezierVolume& volume : random_volumes.volumes) {
    for (double u : {0.0, 1.0}) {
      const auto found = volume.Invert(volume.Position({u, 0.05, -0.02}));
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(found->u, u, 1e-11);
    }
  }
}

TEST(BezierVolumeTest, PointBeyondEitherEndHasNoCoordinates) {
  Random random(5);
  const RandomVolumes random_volumes(random, 1);
  for (const BezierVolume& volume : random_volumes.volumes) {
    for (double u : {0.0, 1.0}) {
      const VolumePoint end = volume.Evaluate({u, 0, 0});
      const Vector3d outwards = (u == 0 ? -1 : 1) * end.along_u.normalized();
      EXPECT_FALSE(volume.Invert(end.position + 1e-9 * outwards).has_value());
    }
  }
}

TEST(BezierVolumeTest, InversionOfNonsenseIsNothing) {
  const auto rig =
      VolumeRig::Create(testing::TwoLinkArm(Vector3d::UnitZ())).value();
  for (double nonsense : {std::nan(""), HUGE_VAL}) {
    for (const BezierVolume& volume : rig->rest().volumes()) {
      EXPECT_FALSE(volume.Invert({nonsense, 0, 0}).has_value());
    }
  }
}

// A tetrahedral mesh of the deformed cylinder through each volume.
double MeshVolume(const BezierVolume& volume, double radius_m) {
  constexpr int kRings = 200;
  constexpr int kAround = 200;
  const auto at = [&](int ring, int around) {
    const double angle = 2 * std::numbers::pi * around / kAround;
    return volume.Position({ring / static_cast<double>(kRings),
                            radius_m * std::cos(angle),
                            radius_m * std::sin(angle)});
  };
  double sum = 0;
  const auto add = [&](const Vector3d& a, const Vector3d& b,
                       const Vector3d& c) { sum += a.dot(b.cross(c)) / 6; };
  const Vector3d start = volume.Position({0, 0, 0});
  const Vector3d end = volume.Position({1, 0, 0});
  for (int a = 0; a < kAround; ++a) {
    for (int i = 0; i < kRings; ++i) {
      add(at(i, a), at(i, a + 1), at(i + 1, a));
      add(at(i, a + 1), at(i + 1, a + 1), at(i + 1, a));
    }
    add(start, at(0, a + 1), at(0, a));
    add(end, at(kRings, a), at(kRings, a + 1));
  }
  return std::abs(sum);
}

TEST(BezierVolumeTest, ClosedFormVolumeIsThatOfAMesh) {
  Random random(6);
  const RandomVolumes random_volumes(random, 1.5);
  constexpr double kRadius = 0.1;
  for (size_t i = 0; i < 8; ++i) {
    const BezierVolume& volume = random_volumes.volumes[i];
    const double exact =
        volume.VolumePerSection() * std::numbers::pi * kRadius * kRadius;
    // A polygon of 200 sides has 0.0165 % less area than its circle.
    EXPECT_NEAR(MeshVolume(volume, kRadius) / exact, 1, 2e-4);
  }
}

TEST(BezierVolumeTest, LeastJacobianIsThatOfASearch) {
  Random random(7);
  const RandomVolumes random_volumes(random, 2);
  const Vector2d half_extents(0.15, 0.1);
  for (const BezierVolume& volume : random_volumes.volumes) {
    double least = HUGE_VAL;
    double size = 0;
    for (int i = 0; i <= 32; ++i) {
      for (int a = 0; a < 720; ++a) {
        const double angle = std::numbers::pi * a / 360;
        const double det =
            volume
                .Evaluate({i / 32.0, half_extents[0] * std::cos(angle),
                           half_extents[1] * std::sin(angle)})
                .Jacobian()
                .determinant();
        least = std::min(least, det);
        size = std::max(size, std::abs(det));
      }
    }
    // The search misses the least angle by at most half a step of 0.5 degrees.
    EXPECT_LE(volume.LeastJacobian(half_extents), least + kRounding);
    EXPECT_NEAR(volume.LeastJacobian(half_extents), least, 1e-5 * size);
  }
}

TEST(BezierVolumeTest, NormalIsThatOfTheDeformedSurface) {
  Random random(8);
  const RandomVolumes rest(random, 1);
  const RandomVolumes bent(random, 1.5);
  for (size_t i = 0; i < rest.volumes.size(); ++i) {
    const VolumeCoordinates at = RandomCoordinates(random, 0.1);
    const Eigen::Matrix3d rest_jacobian =
        rest.volumes[i].Evaluate(at).Jacobian();
    const Vector3d normal = RandomDirection(random);
    const Vector3d tangent = normal.unitOrthogonal();
    const Vector3d other = normal.cross(tangent);
    const Vector3d deformed = DeformedNormal(bent.volumes[i].Evaluate(at),
                                             rest_jacobian.transpose() * normal)
                                  .normalized();
    // Finite differences along the surface.
    constexpr double kStep = 1e-6;
    Vector3d slopes[2];
    for (int k = 0; k < 2; ++k) {
      const Vector3d way =
          kStep * rest_jacobian.inverse() * (k == 0 ? tangent : other);
      slopes[k] = bent.volumes[i].Position(
                      {at.u + way[0], at.s + way[1], at.t + way[2]}) -
                  bent.volumes[i].Position(
                      {at.u - way[0], at.s - way[1], at.t - way[2]});
    }
    const Vector3d want = slopes[0].cross(slopes[1]).normalized();
    // Mirrored volumes turn the surface round.
    const double sign = rest_jacobian.determinant() > 0 ? 1 : -1;
    EXPECT_LE((deformed - sign * want).norm(), 1e-6);
  }
}

TEST(ControlNetTest, SculptedPointsRideOnTheirPlane) {
  Random random(9);
  const Vector2d half_extents(0.4, 0.3);
  const Eigen::Quaterniond turn = testing::RandomRotation(random);
  const Vector3d shift = RandomVector(random, 1);
  std::vector<Vector3d> offsets;
  for (int i = 0; i < 16; ++i) offsets.push_back(RandomVector(random, 0.1));
  std::vector<ControlNet> nets;
  std::vector<ControlNet> moved;
  for (int k = 0; k < 4; ++k) {
    const ControlPlane plane({0.3 * k, 0, 0}, Vector3d::UnitY(),
                             Vector3d::UnitZ());
    const ControlPlane moved_plane(turn * plane.center() + shift,
                                   turn * plane.s_axis(),
                                   turn * plane.t_axis());
    nets.push_back(SculptedNet(plane, half_extents, offsets));
    moved.push_back(SculptedNet(moved_plane, half_extents, offsets));
  }
  const VolumeCoordinates at = {0.3, 0.2, -0.1};
  const Vector3d point = SumOfControlPoints(nets, half_extents, at);
  EXPECT_LE(
      (SumOfControlPoints(moved, half_extents, at) - (turn * point + shift))
          .norm(),
      kRounding);
  EXPECT_GT((point - Vector3d(0.27, 0.2, -0.1)).norm(), 1e-3);
}

}  // namespace
}  // namespace gelenk
