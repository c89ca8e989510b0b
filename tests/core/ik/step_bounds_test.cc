#include "gelenk/ik/step_bounds.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using testing::PoseGoalsAt;
using testing::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Steps are added to a start and compared with the difference: rounding.
constexpr double kRounding = 1e-9;
// What is left of a turn's bound where it meets a limit at a slant.
constexpr double kSlant_rad = 1e-4;

// --- Speed limits ---

std::shared_ptr<const Skeleton> Slider(std::vector<double> max_velocity,
                                       std::vector<double> max_acceleration) {
  Joint joint;
  joint.id = "slider";
  joint.type = JointType::kPrismatic;
  joint.limits.max_velocity = std::move(max_velocity);
  joint.limits.max_acceleration = std::move(max_acceleration);
  return *SkeletonBuilder().AddJoint(joint).Build();
}

StepBounds BoundsOf(const Skeleton& skeleton, absl::Duration interval,
                    double velocity) {
  StepBounds bounds;
  SpeedLimits(skeleton, interval, Eigen::VectorXd::Constant(1, velocity),
              bounds);
  return bounds;
}

TEST(SpeedLimitsTest, VelocityTimesInterval) {
  const auto slider = Slider({2}, {});
  const StepBounds bounds = BoundsOf(*slider, absl::Milliseconds(500), 0.7);
  EXPECT_DOUBLE_EQ(bounds.lower[0], -1);
  EXPECT_DOUBLE_EQ(bounds.upper[0], 1);
  EXPECT_TRUE(HasSpeedLimits(*slider));
}

TEST(SpeedLimitsTest, AccelerationShiftsTheInterval) {
  const auto slider = Slider({10}, {4});
  const StepBounds bounds = BoundsOf(*slider, absl::Milliseconds(500), 3);
  // Between 3 - 2 and 3 + 2 m/s; standing still stays allowed.
  EXPECT_DOUBLE_EQ(bounds.lower[0], 0);
  EXPECT_DOUBLE_EQ(bounds.upper[0], 2.5);
}

TEST(SpeedLimitsTest, WithoutLimitsThereAreNone) {
  const auto slider = Slider({}, {});
  const StepBounds bounds = BoundsOf(*slider, absl::Seconds(1), 0);
  EXPECT_EQ(bounds.lower[0], -kInfinity);
  EXPECT_EQ(bounds.upper[0], kInfinity);
  EXPECT_FALSE(HasSpeedLimits(*slider));
}

TEST(SpeedLimitsTest, NoTimeNoMotion) {
  for (const absl::Duration interval :
       {absl::ZeroDuration(), absl::Seconds(-1)}) {
    const StepBounds bounds = BoundsOf(*Slider({2}, {3}), interval, 0);
    EXPECT_EQ(bounds.lower[0], 0);
    EXPECT_EQ(bounds.upper[0], 0);
  }
}

// --- Bounded solves, on random trees of all joint types ---

class BoundedSolveTest : public ::testing::TestWithParam<int> {
 protected:
  BoundedSolveTest() : random_(GetParam()) {
    testing::SkeletonRecipe recipe;
    recipe.joint_count = 10;
    recipe.frozen = 0;
    // A mimic joint's motion is bounded by its owner's.
    recipe.mimicking = 0.1;
    skeleton_ = testing::RandomSkeleton(random_, recipe);
    start_ = testing::RandomPoseWithinLimits(random_, *skeleton_);
    target_ = testing::RandomPoseWithinLimits(random_, *skeleton_);
    problem_ = std::make_unique<IkProblem>(
        *IkProblem::Create(skeleton_, PoseGoalsAt(*skeleton_, target_)));
  }

  Eigen::VectorXd Change(const Eigen::VectorXd& from,
                         const Eigen::VectorXd& to) const {
    Eigen::VectorXd change(skeleton_->velocity_count());
    Difference(*skeleton_, from, to, change);
    return change;
  }

  // Sum of squares of what is left, as the solver sees it.
  double Missing(const SolveReport& report) const {
    double sum = 0;
    for (double error : report.position_errors_m) sum += error * error;
    for (double error : report.rotation_errors_rad) sum += error * error;
    return sum;
  }

  Random random_;
  std::shared_ptr<const Skeleton> skeleton_;
  Eigen::VectorXd start_;
  Eigen::VectorXd target_;
  std::unique_ptr<IkProblem> problem_;
  IkSolver solver_;
  SolverOptions options_;
  SolveReport report_;
};

TEST_P(BoundedSolveTest, NoDegreeOfFreedomMovesFurther) {
  for (const double step : {0.01, 0.1, 0.5}) {
    options_.max_step = step;
    Eigen::VectorXd q = start_;
    solver_.Solve(*problem_, options_, SolveStart::kWarm, q, report_);
    EXPECT_LE(Change(start_, q).cwiseAbs().maxCoeff(), step + kSlant_rad);
    EXPECT_LE(LimitExcess(*skeleton_, q, nullptr), kRounding);
  }
}

TEST_P(BoundedSolveTest, EachFrameGetsNearer) {
  options_.max_step = 0.1;
  Eigen::VectorXd q = start_;
  solver_.Solve(*problem_, options_, SolveStart::kWarm, q, report_);
  double before = Missing(report_);
  for (int frame = 0; frame < 20; ++frame) {
    solver_.Solve(*problem_, options_, SolveStart::kWarm, q, report_);
    EXPECT_LE(Missing(report_), before * (1 + 1e-6) + 1e-12);
    before = Missing(report_);
  }
}

TEST_P(BoundedSolveTest, ATargetInsideTheBoundIsReached) {
  Eigen::VectorXd near(skeleton_->position_count());
  Integrate(*skeleton_, start_,
            testing::RandomVelocity(random_, *skeleton_, 0.02), near);
  ClampToLimits(*skeleton_, near);
  const IkProblem problem =
      *IkProblem::Create(skeleton_, PoseGoalsAt(*skeleton_, near));
  options_.max_step = 0.2;
  Eigen::VectorXd q = start_;
  solver_.Solve(problem, options_, SolveStart::kWarm, q, report_);
  EXPECT_EQ(report_.outcome, SolveOutcome::kConverged);
}

TEST_P(BoundedSolveTest, AColdStartIsNotBounded) {
  options_.max_step = 1e-6;
  options_.max_restarts = 0;
  Eigen::VectorXd q = start_;
  solver_.Solve(*problem_, options_, SolveStart::kCold, q, report_);
  Eigen::VectorXd free = start_;
  options_.max_step.reset();
  solver_.Solve(*problem_, options_, SolveStart::kCold, free, report_);
  EXPECT_EQ(q, free);
}

TEST_P(BoundedSolveTest, BoundsAndMaxStepBothCount) {
  StepBounds bounds;
  bounds.lower.setConstant(skeleton_->velocity_count(), -0.01);
  bounds.upper.setConstant(skeleton_->velocity_count(), 0.03);
  options_.max_step = 0.02;
  Eigen::VectorXd q = start_;
  solver_.Solve(*problem_, options_, SolveStart::kWarm, q, report_, &bounds);
  const Eigen::VectorXd change = Change(start_, q);
  EXPECT_GE(change.minCoeff(), -0.01 - kRounding);
  EXPECT_LE(change.maxCoeff(), 0.02 + kRounding);
}

INSTANTIATE_TEST_SUITE_P(Seeds, BoundedSolveTest, ::testing::Range(1, 25));

}  // namespace
}  // namespace gelenk
