#include "gelenk/ik/two_link_solver.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::EffectorPose;
using testing::Fails;
using testing::OraclePositionError;
using testing::PoseGoalFor;
using testing::PositionGoalFor;
using testing::Random;
using testing::RandomDirection;
using testing::RandomTransform;
using testing::Uniform;
using testing::WithProbability;

constexpr double kExact_m = 1e-12;

// "root" (fixed), "upper", "between" (fixed), "lower", "after" (fixed), "tip":
// any plane, any offsets, axes along each other or opposite.
std::shared_ptr<const Skeleton> RandomLinks(Random& random, bool limited) {
  SkeletonBuilder builder;
  std::string parent;
  Eigen::Quaterniond skeleton_from_parent = Eigen::Quaterniond::Identity();
  const Eigen::Vector3d axis = RandomDirection(random);
  for (const char* id : {"root", "upper", "between", "lower", "after"}) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent;
    parent = id;
    joint.parent_from_joint = RandomTransform(random, 0.5);
    skeleton_from_parent =
        skeleton_from_parent * joint.parent_from_joint.rotation;
    const bool turns = joint.id == "upper" || joint.id == "lower";
    if (turns) {
      joint.type = JointType::kRevolute;
      const double sign = WithProbability(random, 0.5) ? 1 : -1;
      joint.axis = sign * (skeleton_from_parent.conjugate() * axis);
    }
    if (turns && limited) {
      joint.limits.lower = {Uniform(random, -2, 0)};
      joint.limits.upper = {Uniform(random, 0, 2)};
    }
    builder.AddJoint(joint);
  }
  builder.AddEndEffector({"tip", parent, RandomTransform(random, 0.5)});
  return *builder.Build();
}

struct Answer {
  Eigen::VectorXd positions;
  SolveReport report;
};

Answer Solve(const std::shared_ptr<const Skeleton>& skeleton,
             const Eigen::Vector3d& target, SolverMethod method,
             const Eigen::VectorXd& start) {
  SolverOptions options;
  options.method = method;
  options.position_tolerance_m = 1e-9;
  const IkProblem problem =
      *IkProblem::Create(skeleton, {PositionGoalFor("tip", target)});
  EXPECT_TRUE(IkSolver::Check(problem, options).ok());
  Answer answer = {start, {}};
  IkSolver().Solve(problem, options, SolveStart::kCold, answer.positions,
                   answer.report);
  return answer;
}

TEST(TwoLinkSolverTest, ReachesWhatIsInReachInAnyPlane) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const auto skeleton = RandomLinks(random, WithProbability(random, 0.5));
    const Eigen::VectorXd truth =
        testing::RandomPoseWithinLimits(random, *skeleton);
    const Eigen::Vector3d target =
        EffectorPose(*skeleton, truth, "tip").translation;
    const Answer answer = Solve(skeleton, target, SolverMethod::kTwoLink,
                                Eigen::Vector2d(0.1, 0.2));
    EXPECT_EQ(answer.report.outcome, SolveOutcome::kConverged);
    EXPECT_EQ(answer.report.method, SolverMethod::kTwoLink);
    EXPECT_EQ(LimitExcess(*skeleton, answer.positions, nullptr), 0);
    EXPECT_LT(OraclePositionError(*skeleton, PositionGoalFor("tip", target),
                                  answer.positions),
              kExact_m);
  }
}

TEST(TwoLinkSolverTest, ComesAsNearAsTheDefaultSolverDoes) {
  Random random(2);
  int missed = 0;
  for (int i = 0; i < 60; ++i) {
    const auto skeleton = RandomLinks(random, WithProbability(random, 0.5));
    const Eigen::Vector3d target = testing::RandomVector(random, 1.5);
    const Eigen::Vector2d start(0.1, 0.2);
    const Answer answer =
        Solve(skeleton, target, SolverMethod::kTwoLink, start);
    const Answer other =
        Solve(skeleton, target, SolverMethod::kLevenbergMarquardt, start);
    EXPECT_NEAR(answer.report.position_errors_m[0],
                OraclePositionError(*skeleton, PositionGoalFor("tip", target),
                                    answer.positions),
                kExact_m);
    EXPECT_LT(answer.report.position_errors_m[0],
              other.report.position_errors_m[0] + 1e-9);
    missed += answer.report.outcome != SolveOutcome::kConverged;
  }
  // Targets off the plane: all of them.
  EXPECT_EQ(missed, 60);
}

TEST(TwoLinkSolverTest, StaysOnItsBranch) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const auto skeleton = RandomLinks(random, false);
    const Eigen::VectorXd truth = testing::RandomPose(random, *skeleton);
    const Eigen::Vector3d target =
        EffectorPose(*skeleton, truth, "tip").translation;
    const Answer answer =
        Solve(skeleton, target, SolverMethod::kTwoLink, truth);
    EXPECT_LT((answer.positions - truth).norm(), 1e-6);
    EXPECT_LT(answer.report.change, 1e-6);
  }
}

TEST(TwoLinkSolverTest, AGoalThatIsOffMovesNothing) {
  Random random(4);
  const auto skeleton = RandomLinks(random, false);
  Goal goal = PositionGoalFor("tip", Eigen::Vector3d(1, 2, 3));
  goal.weight = 0;
  const IkProblem problem = *IkProblem::Create(skeleton, {goal});
  SolverOptions options;
  options.method = SolverMethod::kTwoLink;
  Eigen::VectorXd positions = Eigen::Vector2d(0.3, 0.4);
  SolveReport report;
  IkSolver().Solve(problem, options, SolveStart::kWarm, positions, report);
  EXPECT_EQ(positions, Eigen::VectorXd(Eigen::Vector2d(0.3, 0.4)));
  EXPECT_EQ(report.outcome, SolveOutcome::kConverged);
}

// --- What it is not for ---

absl::Status CheckWith(const std::shared_ptr<const Skeleton>& skeleton,
                       std::vector<Goal> goals) {
  SolverOptions options;
  options.method = SolverMethod::kTwoLink;
  return IkSolver::Check(*IkProblem::Create(skeleton, std::move(goals)),
                         options);
}

std::shared_ptr<const Skeleton> Hinges(std::vector<Eigen::Vector3d> axes) {
  SkeletonBuilder builder;
  for (size_t i = 0; i < axes.size(); ++i) {
    Joint joint;
    joint.id = "j" + std::to_string(i);
    if (i > 0) joint.parent_id = "j" + std::to_string(i - 1);
    joint.type = JointType::kRevolute;
    joint.axis = axes[i];
    joint.parent_from_joint.translation.x() = i > 0 ? 1 : 0;
    builder.AddJoint(joint);
  }
  EndEffector tip;
  tip.id = "tip";
  tip.joint_id = "j" + std::to_string(axes.size() - 1);
  tip.joint_from_end_effector.translation.x() = 1;
  return *builder.AddEndEffector(tip).Build();
}

TEST(TwoLinkSolverTest, OtherProblemsAreRefusedWithTheReason) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Goal point = PositionGoalFor("tip", x);
  EXPECT_TRUE(CheckWith(Hinges({z, -z}), {point}).ok());
  EXPECT_THAT(CheckWith(Hinges({z, z, z}), {point}),
              Fails(absl::StatusCode::kInvalidArgument,
                    "method: two-link: joint \"j0\" is one more than two "
                    "that move \"tip\""));
  EXPECT_THAT(CheckWith(Hinges({z}), {point}),
              Fails(absl::StatusCode::kInvalidArgument,
                    "method: two-link: want two joints that move "
                    "\"tip\""));
  EXPECT_THAT(CheckWith(Hinges({z, x}), {point}),
              Fails(absl::StatusCode::kInvalidArgument,
                    "method: two-link: the axes of \"j0\" and \"j1\" are "
                    "not parallel"));
  EXPECT_THAT(CheckWith(Hinges({z, z}), {PositionGoalFor("j1", x)}),
              Fails(absl::StatusCode::kInvalidArgument,
                    "method: two-link: a link has no length"));
  EXPECT_THAT(CheckWith(Hinges({z, z}), {PoseGoalFor("tip", RigidTransform())}),
              Fails(absl::StatusCode::kInvalidArgument,
                    "method: two-link: want a position goal, along all axes"));
  EXPECT_THAT(CheckWith(Hinges({z, z}), {}),
              Fails(absl::StatusCode::kInvalidArgument,
                    "method: two-link: want one goal"));
}

}  // namespace
}  // namespace gelenk
