#include "gelenk/ik/level_step.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>

#include "tests/testing/random.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::Uniform;
using ::gelenk::testing::UniformIndex;
using ::gelenk::testing::WithProbability;

constexpr double kFeasible = 1e-9;
// What a point gains that is feasible to no more than that, by forces up to
// 100.
constexpr double kSameObjective = 1e-7;

// A step's problem, and what it says about a point.
struct Problem {
  Eigen::MatrixXd equations, at_least, rows;
  Eigen::VectorXd floors, wish, diagonal, pull, lower, upper;

  double Objective(const Eigen::VectorXd& x) const {
    return 0.5 * (rows * x - wish).squaredNorm() +
           0.5 * x.dot(diagonal.cwiseProduct(x)) - pull.dot(x);
  }
  bool IsFeasible(const Eigen::VectorXd& x) const {
    return (equations * x).cwiseAbs().sum() < kFeasible &&
           (at_least * x - floors).cwiseMin(0).sum() > -kFeasible &&
           (x - lower).minCoeff() > -kFeasible &&
           (upper - x).minCoeff() > -kFeasible;
  }
};

Eigen::MatrixXd RandomMatrix(Random& random, int rows, int columns) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns,
                                      [&] { return Uniform(random, -1, 1); });
}

Problem RandomProblem(Random& random, int n) {
  Problem p;
  p.equations = RandomMatrix(random, UniformIndex(random, n / 2 + 1), n);
  // Linearly dependent equations are taken.
  if (p.equations.rows() > 1) p.equations.row(0) = -2 * p.equations.row(1);
  p.at_least = RandomMatrix(random, UniformIndex(random, 3), n);
  p.rows = RandomMatrix(random, 1 + UniformIndex(random, n), n);
  p.floors = -RandomMatrix(random, p.at_least.rows(), 1).cwiseAbs();
  p.wish = 3 * RandomMatrix(random, p.rows.rows(), 1);
  p.diagonal = RandomMatrix(random, n, 1).cwiseAbs().array() + 1e-3;
  p.pull = RandomMatrix(random, n, 1);
  p.lower = -RandomMatrix(random, n, 1).cwiseAbs();
  p.upper = RandomMatrix(random, n, 1).cwiseAbs();
  for (int i = 0; i < n; ++i) {
    if (WithProbability(random, 0.2)) p.lower[i] = 0;
    if (WithProbability(random, 0.2)) p.upper[i] = 0;
  }
  return p;
}

void Load(const Problem& p, LevelStep& step) {
  const int n = static_cast<int>(p.diagonal.size());
  const int equations = static_cast<int>(p.equations.rows());
  const int at_least = static_cast<int>(p.at_least.rows());
  const int rows = static_cast<int>(p.rows.rows());
  step.Reserve(n, equations + at_least, rows);
  step.AddConstraints(equations, false) = p.equations;
  step.AddConstraints(at_least, true) = p.at_least;
  for (int r = 0; r < at_least; ++r) {
    step.SetConstraint(equations + r, p.floors[r]);
  }
  step.AddRows(rows) = p.rows;
  for (int r = 0; r < rows; ++r) step.SetRow(r, p.wish[r]);
  for (int i = 0; i < n; ++i) {
    step.SetColumn(i, p.diagonal[i], p.pull[i]);
    step.SetBounds(i, p.lower[i], p.upper[i]);
  }
}

// The problem is convex: a feasible point is the best one when no way from it
// to another feasible point goes down.
TEST(LevelStepTest, NoFeasiblePointIsBetter) {
  Random random(4);
  LevelStep step;
  int settled = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Problem p = RandomProblem(random, 2 + trial % 9);
    Load(p, step);
    if (!step.Solve()) continue;
    ++settled;
    const Eigen::VectorXd x = step.step();
    ASSERT_TRUE(p.IsFeasible(x)) << trial;
    const double objective = p.Objective(x);
    EXPECT_NEAR(p.Objective(0 * x) - objective, step.gain(), 1e-9) << trial;
    const Eigen::MatrixXd null_space =
        p.equations.rows() == 0
            ? Eigen::MatrixXd::Identity(x.size(), x.size()).eval()
            : Eigen::MatrixXd(p.equations.fullPivLu().kernel());
    for (int other = 0; other < 100; ++other) {
      // The feasible set is star-shaped about 0.
      Eigen::VectorXd y =
          null_space * RandomMatrix(random, int(null_space.cols()), 1);
      for (int k = 0; k < 60 && !p.IsFeasible(y); ++k) y *= 0.7;
      if (!p.IsFeasible(y)) continue;
      for (double part : {1e-3, 0.1, 1.0}) {
        EXPECT_GE(p.Objective(x + part * (y - x)), objective - kSameObjective)
            << trial;
      }
    }
  }
  EXPECT_GE(settled, kTrials - 5);
}

TEST(LevelStepTest, OneSidedRowsOnlyPush) {
  LevelStep step;
  for (double wish : {0.5, -0.5}) {
    for (double pull : {0.0, 2.0, -2.0}) {
      step.Reserve(1, 0, 1);
      step.AddRows(1)(0, 0) = 10;
      step.SetRow(0, 10 * wish);
      step.SetOneSided(0, wish > 0);
      step.SetColumn(0, 1, pull);
      step.SetBounds(0, -5, 5);
      ASSERT_TRUE(step.Solve());
      // Where the pull leads to already it has no say.
      const double both = (pull + 100 * wish) / 101;
      EXPECT_NEAR(step.step()[0], pull >= wish ? pull : both, 1e-12)
          << wish << " " << pull;
      EXPECT_EQ(step.Counts(0), pull < wish);
    }
  }
}

TEST(LevelStepTest, ConstraintsAreBroughtToTheirValuesWithinBounds) {
  LevelStep step;
  step.Reserve(3, 1, 0);
  LevelStep::MatrixView row = step.AddConstraints(1, false);
  row << 1, 1, 1;
  step.SetConstraint(0, 0.9);
  for (int i = 0; i < 3; ++i) {
    step.SetColumn(i, 1, 0);
    step.SetBounds(i, -1, i == 0 ? 0.1 : 1);
  }
  ASSERT_TRUE(step.SolveConstraints());
  EXPECT_NEAR(step.step()[0], 0.1, 1e-12);
  EXPECT_NEAR(step.step()[1], 0.4, 1e-12);
  EXPECT_NEAR(step.step()[2], 0.4, 1e-12);
  // Out of bounds.
  step.SetConstraint(0, 2.2);
  EXPECT_FALSE(step.SolveConstraints());
}

}  // namespace
}  // namespace gelenk
