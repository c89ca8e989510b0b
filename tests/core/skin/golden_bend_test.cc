// A two-link arm bent by 0, 45 and 90 degrees, with and without a biceps:
// control points and points of the volumes as plain arithmetic gives them, the
// latter by the sum over 64 control points. Written down once, by a program of
// its own; no later change of the volumes may move them.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "gelenk/skin/control_net.h"
#include "gelenk/skin/volume_rig.h"
#include "tests/core/skin/skin_chains.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-13;

struct GoldenPoint {
  double bend_degrees;
  bool muscle;
  int link;
  int half;
  VolumeCoordinates at;
  Vector3d position;
};

struct GoldenCorner {
  double bend_degrees;
  bool muscle;
  int link;
  int plane;
  Vector3d corner;  // at s = t = 0.2 m
};

// clang-format off
const GoldenPoint kPoints[] = {
    {0, false, 0, 0, {0.75, 0.1, 0.15}, {0.375, 0.1000000000000001, 0.15}},
    {0, false, 0, 1, {0.5, 0.2, 0}, {0.75, 0.2, 0}},
    {0, false, 0, 1, {0.9, -0.2, 0.1}, {0.9500000000000002, -0.2, 0.1000000000000001}},
    {0, false, 1, 0, {0.25, -0.1, -0.2}, {1.125, -0.1, -0.2}},
    {0, false, 1, 1, {0.6, 0.15, 0.05}, {1.8, 0.15, 0.05}},
    {0, true, 0, 0, {0.75, 0.1, 0.15}, {0.375, 0.1000000000000001, 0.15}},
    {0, true, 0, 1, {0.5, 0.2, 0}, {0.75, 0.2, 0}},
    {0, true, 0, 1, {0.9, -0.2, 0.1}, {0.9500000000000002, -0.2, 0.1000000000000001}},
    {0, true, 1, 0, {0.25, -0.1, -0.2}, {1.125, -0.1, -0.2}},
    {0, true, 1, 1, {0.6, 0.15, 0.05}, {1.8, 0.15, 0.05}},
    {45, false, 0, 0, {0.75, 0.1, 0.15}, {0.375, 0.1000000000000001, 0.15}},
    {45, false, 0, 1, {0.5, 0.2, 0}, {0.7164891859815355, 0.1684702387283107, 0}},
    {45, false, 0, 1, {0.9, -0.2, 0.1}, {1.027476538185066, -0.2007008601309803, 0.1000000000000001}},
    {45, false, 1, 0, {0.25, -0.1, -0.2}, {1.146967639787683, -0.02342354807736995, -0.2}},
    {45, false, 1, 1, {0.6, 0.15, 0.05}, {1.459619407771255, 0.6717514421272202, 0.05}},
    {45, true, 0, 0, {0.75, 0.1, 0.15}, {0.375, 0.1123564326686926, 0.1546336622507597}},
    {45, true, 0, 1, {0.5, 0.2, 0}, {0.7164891859815355, 0.1794537344338152, 0}},
    {45, true, 0, 1, {0.9, -0.2, 0.1}, {1.027476538185066, -0.2009058853841497, 0.1001025126265848}},
    {45, true, 1, 0, {0.25, -0.1, -0.2}, {1.146967639787683, -0.02342354807736995, -0.2}},
    {45, true, 1, 1, {0.6, 0.15, 0.05}, {1.459619407771255, 0.6717514421272202, 0.05}},
    {90, false, 0, 0, {0.75, 0.1, 0.15}, {0.375, 0.1000000000000001, 0.15}},
    {90, false, 0, 1, {0.5, 0.2, 0}, {0.697595148057186, 0.1265165042944956, 0}},
    {90, false, 0, 1, {0.9, -0.2, 0.1}, {1.09932373362461, -0.1716993829007201, 0.1000000000000001}},
    {90, false, 1, 0, {0.25, -0.1, -0.2}, {1.125005580214794, 0.04474381088956415, -0.2}},
    {90, false, 1, 1, {0.6, 0.15, 0.05}, {0.8500000000000001, 0.7999999999999999, 0.05}},
    {90, true, 0, 0, {0.75, 0.1, 0.15}, {0.375, 0.1421875000000001, 0.1658203125000001}},
    {90, true, 0, 1, {0.5, 0.2, 0}, {0.697595148057186, 0.1640165042944957, 0}},
    {90, true, 0, 1, {0.9, -0.2, 0.1}, {1.09932373362461, -0.17239938290072, 0.1003500000000001}},
    {90, true, 1, 0, {0.25, -0.1, -0.2}, {1.125005580214794, 0.04474381088956415, -0.2}},
    {90, true, 1, 1, {0.6, 0.15, 0.05}, {0.8500000000000001, 0.7999999999999999, 0.05}},
};

const GoldenCorner kCorners[] = {
    {0, false, 0, 2, {0.3333333333333333, 0.2, 0.2}},
    {0, false, 0, 5, {0.8333333333333334, 0.2, 0.2}},
    {0, false, 0, 6, {1, 0.2, 0.2}},
    {0, false, 1, 1, {1.166666666666667, 0.2, 0.2}},
    {0, false, 1, 3, {1.5, 0.2, 0.2}},
    {0, true, 0, 2, {0.3333333333333333, 0.2, 0.2}},
    {0, true, 0, 5, {0.8333333333333334, 0.2, 0.2}},
    {0, true, 0, 6, {1, 0.2, 0.2}},
    {0, true, 1, 1, {1.166666666666667, 0.2, 0.2}},
    {0, true, 1, 3, {1.5, 0.2, 0.2}},
    {45, false, 0, 2, {0.3333333333333333, 0.2, 0.2}},
    {45, false, 0, 5, {0.7694833914417676, 0.1209953344414091, 0.2}},
    {45, false, 0, 6, {0.9234633135269821, 0.1847759065022574, 0.2}},
    {45, false, 1, 1, {1.077443235612197, 0.2485564785631056, 0.2}},
    {45, false, 1, 3, {1.212132034355964, 0.4949747468305833, 0.2}},
    {45, true, 0, 2, {0.3333333333333333, 0.2219669914110089, 0.2073223304703363}},
    {45, true, 0, 5, {0.7694833914417676, 0.1209953344414091, 0.2}},
    {45, true, 0, 6, {0.9234633135269821, 0.1847759065022574, 0.2}},
    {45, true, 1, 1, {1.077443235612197, 0.2485564785631056, 0.2}},
    {45, true, 1, 3, {1.212132034355964, 0.4949747468305833, 0.2}},
    {90, false, 0, 2, {0.3333333333333333, 0.2, 0.2}},
    {90, false, 0, 5, {0.7407275135649325, 0.02357022603955163, 0.2}},
    {90, false, 0, 6, {0.8585786437626906, 0.1414213562373095, 0.2}},
    {90, false, 1, 1, {0.9764297739604484, 0.2592724864350675, 0.2}},
    {90, false, 1, 3, {0.8, 0.5, 0.2}},
    {90, true, 0, 2, {0.3333333333333333, 0.275, 0.225}},
    {90, true, 0, 5, {0.7407275135649325, 0.02357022603955163, 0.2}},
    {90, true, 0, 6, {0.8585786437626906, 0.1414213562373095, 0.2}},
    {90, true, 1, 1, {0.9764297739604484, 0.2592724864350675, 0.2}},
    {90, true, 1, 3, {0.8, 0.5, 0.2}},
};
// clang-format on

class GoldenBendTest : public ::testing::Test {
 protected:
  VolumeFrame Bent(double degrees, bool muscle) {
    SkinMuscles muscles;
    if (muscle) {
      Muscle& biceps = muscles.muscles.emplace_back();
      biceps.id = "biceps";
      biceps.link_id = "upper";
      biceps.driver_joint_id = "lower";
      biceps.gain_s = 0.5;
      biceps.gain_t = 0.25;
      biceps.pivot_m = {-0.1, 0};
    }
    rig_ = VolumeRig::Create(arm_, {}, muscles).value();
    VolumeFrame frame;
    rig_->Evaluate(testing::ElbowAt(*arm_, degrees * std::numbers::pi / 180),
                   {}, frame);
    return frame;
  }

  std::shared_ptr<const Skeleton> arm_ = testing::TwoLinkArm(Vector3d::UnitZ());
  std::shared_ptr<const VolumeRig> rig_;
};

TEST_F(GoldenBendTest, ControlPointsAreWhereTheyWere) {
  for (const GoldenCorner& golden : kCorners) {
    const VolumeFrame frame = Bent(golden.bend_degrees, golden.muscle);
    EXPECT_LE(
        (frame.planes(golden.link)[golden.plane](0.2, 0.2) - golden.corner)
            .norm(),
        kRounding)
        << golden.bend_degrees << " P" << golden.plane;
  }
}

TEST_F(GoldenBendTest, VolumesAreWhereTheyWere) {
  const Eigen::Vector2d half_extents(0.2, 0.2);
  for (const GoldenPoint& golden : kPoints) {
    const VolumeFrame frame = Bent(golden.bend_degrees, golden.muscle);
    std::vector<ControlNet> nets;
    for (const ControlPlane& plane :
         frame.planes(golden.link).subspan(3 * golden.half, 4)) {
      nets.push_back(UniformNet(plane, half_extents));
    }
    EXPECT_LE(
        (SumOfControlPoints(nets, half_extents, golden.at) - golden.position)
            .norm(),
        kRounding);
    const int volume =
        rig_->volume(golden.link, static_cast<VolumePart>(golden.half));
    EXPECT_LE(
        (frame.volume(volume).Position(golden.at) - golden.position).norm(),
        kRounding);
  }
}

}  // namespace
}  // namespace gelenk
