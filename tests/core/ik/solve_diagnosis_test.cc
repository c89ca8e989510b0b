#include "gelenk/ik/solve_diagnosis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/ik_targets.h"

namespace gelenk {
namespace {

using ::gelenk::testing::PandaArm;
using ::gelenk::testing::PlanarChain;
using ::gelenk::testing::PoseGoalFor;
using ::gelenk::testing::PositionGoalFor;
using ::gelenk::testing::RotationGoalFor;

// A few operations on numbers near 1.
constexpr double kRounding = 1e-13;

// The planar part of a goal on "tip".
IkProblem PlanarProblem(std::shared_ptr<const Skeleton> chain) {
  Goal goal = PositionGoalFor("tip", {0, 0, 0});
  std::get<PositionGoal>(goal.kind).axes.z = false;
  return IkProblem::Create(std::move(chain), {goal}).value();
}

SolveReport DiagnosisOf(const IkProblem& problem,
                        const Eigen::VectorXd& positions) {
  SolveReport report;
  Diagnose(problem, positions, report);
  return report;
}

// Of two links the manipulability is l1 l2 |sin(phi2)|.
TEST(DiagnoseTest, TwoLinkManipulabilityIsTheTextbooks) {
  const IkProblem problem =
      PlanarProblem(PlanarChain(Eigen::Vector3d::Zero(), {2, 0.5}));
  for (double phi : {-1.0, 0.3, 2.0}) {
    const SolveReport report = DiagnosisOf(problem, Eigen::Vector2d(0.7, phi));
    EXPECT_NEAR(report.translation_manipulability, std::abs(std::sin(phi)),
                kRounding);
    EXPECT_EQ(report.rotation_manipulability, 0);
    EXPECT_EQ(report.rank, 2);
    EXPECT_EQ(report.free_velocity_count, 0);
  }
}

TEST(DiagnoseTest, StretchedArmLosesARank) {
  const IkProblem problem =
      PlanarProblem(PlanarChain(Eigen::Vector3d::Zero(), {1, 1, 1}));
  const SolveReport bent = DiagnosisOf(problem, Eigen::Vector3d(0, 1, 1));
  EXPECT_EQ(bent.rank, 2);
  EXPECT_EQ(bent.free_velocity_count, 1);
  const SolveReport stretched = DiagnosisOf(problem, Eigen::Vector3d::Zero());
  EXPECT_EQ(stretched.rank, 1);
  EXPECT_EQ(stretched.free_velocity_count, 2);
  EXPECT_NEAR(stretched.translation_manipulability, 0, kRounding);
}

TEST(DiagnoseTest, FewerColumnsThanRowsHaveNone) {
  const auto chain = PlanarChain(Eigen::Vector3d::Zero(), {1, 1});
  const IkProblem problem =
      IkProblem::Create(chain, {PositionGoalFor("tip", {0, 0, 0})}).value();
  EXPECT_EQ(
      DiagnosisOf(problem, Eigen::Vector2d(0, 1)).translation_manipulability,
      0);
}

TEST(DiagnoseTest, PosesHaveBothManipulabilities) {
  Eigen::VectorXd q(7);
  q << 0.1, 0.3, -0.2, -1.5, 0.4, 1.8, 0.6;
  const auto panda = PandaArm();
  const SolveReport pose = DiagnosisOf(
      IkProblem::Create(panda, {PoseGoalFor("tip", {})}).value(), q);
  EXPECT_EQ(pose.rank, 6);
  EXPECT_EQ(pose.free_velocity_count, 1);
  const SolveReport position = DiagnosisOf(
      IkProblem::Create(panda, {PositionGoalFor("tip", {0, 0, 0})}).value(), q);
  const SolveReport rotation = DiagnosisOf(
      IkProblem::Create(panda, {RotationGoalFor("tip", {1, 0, 0, 0})}).value(),
      q);
  EXPECT_GT(pose.translation_manipulability, 0.01);
  EXPECT_NEAR(pose.translation_manipulability,
              position.translation_manipulability, kRounding);
  EXPECT_NEAR(pose.rotation_manipulability, rotation.rotation_manipulability,
              kRounding);
  EXPECT_EQ(position.rank, 3);
  EXPECT_EQ(position.rotation_manipulability, 0);
}

TEST(DiagnoseTest, ARotationThatCountsNothingDoesNotCount) {
  Goal goal = PoseGoalFor("tip", {});
  std::get<PoseGoal>(goal.kind).rotation_scale_m_per_rad = 0;
  const SolveReport report =
      DiagnosisOf(IkProblem::Create(PandaArm(), {goal}).value(),
                  Eigen::VectorXd::Constant(7, -0.5));
  EXPECT_EQ(report.rank, 3);
  EXPECT_EQ(report.rotation_manipulability, 0);
}

TEST(DiagnoseTest, GoalsThatAreOffDoNotCount) {
  Goal off = PoseGoalFor("tip", {});
  off.weight = 0;
  const SolveReport report = DiagnosisOf(
      IkProblem::Create(PandaArm(), {off}).value(), Eigen::VectorXd::Zero(7));
  EXPECT_EQ(report.rank, 0);
  EXPECT_EQ(report.free_velocity_count, 7);
}

TEST(WeightedChangeTest, IsTheStiffnessMetric) {
  Joint slider;
  slider.id = "slider";
  slider.type = JointType::kPrismatic;
  slider.stiffness = {4};
  Joint ball;
  ball.id = "ball";
  ball.parent_id = "slider";
  ball.type = JointType::kSpherical;
  const auto skeleton =
      SkeletonBuilder().AddJoint(slider).AddJoint(ball).Build().value();
  const IkProblem problem = IkProblem::Create(skeleton, {}).value();
  Eigen::VectorXd from = NeutralPositions(*skeleton);
  Eigen::VectorXd to(5);
  Eigen::Vector4d velocity(1.5, 0, 4, 0);
  velocity.normalize();
  Integrate(*skeleton, from, velocity, to);
  Eigen::VectorXd change(4);
  const double want =
      std::sqrt(4 * velocity[0] * velocity[0] + velocity[2] * velocity[2]);
  EXPECT_NEAR(WeightedChange(problem, from, to, change), want, kRounding);
  EXPECT_LE((change - velocity).norm(), kRounding);
  EXPECT_EQ(WeightedChange(problem, from, from, change), 0);
}

}  // namespace
}  // namespace gelenk
