// The rows of every kind of goal against finite differences, on random trees
// with mimic, ball, free, planar and sliding joints.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/goal_linearizer.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/random_goals.h"
#include "tests/testing/random_pose.h"
#include "tests/testing/random_skeleton.h"

namespace gelenk {
namespace {

using ::gelenk::testing::Random;
using ::gelenk::testing::RandomGoal;
using ::gelenk::testing::RandomPose;
using ::gelenk::testing::RandomSkeleton;
using ::gelenk::testing::RandomVector;
using ::gelenk::testing::SkeletonRecipe;
using ::gelenk::testing::UniformIndex;

using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Central differences: h^2 times a third derivative, and 1e-14 / h of rounding.
constexpr double kStep = 1e-5;
// Relative. Where the goals fade out near a singular place, a fading factor
// counts as constant; that leaves up to 1e-4 where things are not steep.
constexpr double kDifferenceError = 1e-4;

struct Linearized {
  kernel::GoalRows rows = {};
  RowMajorMatrix jacobian;

  Eigen::VectorXd residual() const {
    return Eigen::Map<const Eigen::VectorXd>(rows.residual, jacobian.rows());
  }
};

// The only goal of `problem`.
Linearized LinearizeAt(const IkProblem& problem,
                       const Eigen::VectorXd& positions) {
  const kernel::TaskTarget& target = problem.targets()[0];
  Linearized out;
  out.jacobian.resize(GoalLinearizer::RowCount(target),
                      problem.skeleton().velocity_count());
  GoalLinearizer linearizer;
  linearizer.SetProblem(problem);
  linearizer.MoveTo(positions);
  linearizer.Evaluate(0, target, out.rows);
  linearizer.ComputeJacobian(0, target, out.rows, positions, out.jacobian);
  return out;
}

// Half the square of the translation that counts, and the angles' energy.
double Energy(const IkProblem& problem, const Linearized& at) {
  const kernel::TaskTarget& target = problem.targets()[0];
  double energy =
      target.row_scale[3] * target.row_scale[3] * at.rows.rotation_energy;
  for (int r = 0; r < target.translation_rows; ++r) {
    const double e = target.row_scale[r] * at.rows.residual[r];
    energy += 0.5 * e * e;
  }
  return energy;
}

// Of the energy, by the rows.
Eigen::VectorXd Gradient(const IkProblem& problem, const Linearized& at) {
  const kernel::TaskTarget& target = problem.targets()[0];
  Eigen::VectorXd weighted = at.residual();
  for (int r = 0; r < weighted.size(); ++r) {
    const double scale = target.row_scale[r < target.translation_rows ? r : 3];
    weighted[r] *= scale * scale;
  }
  return -at.jacobian.transpose() * weighted;
}

Eigen::VectorXd Moved(const Skeleton& skeleton,
                      const Eigen::VectorXd& positions, int column,
                      double step) {
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(skeleton.velocity_count());
  velocity[column] = step;
  Eigen::VectorXd moved(positions.size());
  Integrate(skeleton, positions, velocity, moved);
  return moved;
}

template <class Function>
Eigen::MatrixXd Differences(const Skeleton& skeleton,
                            const Eigen::VectorXd& positions,
                            const Function& f) {
  Eigen::MatrixXd quotients;
  for (int c = 0; c < skeleton.velocity_count(); ++c) {
    const Eigen::VectorXd ahead = f(Moved(skeleton, positions, c, kStep));
    const Eigen::VectorXd behind = f(Moved(skeleton, positions, c, -kStep));
    quotients.conservativeResize(ahead.size(), skeleton.velocity_count());
    quotients.col(c) = (ahead - behind) / (2 * kStep);
  }
  return quotients;
}

IkProblem ProblemOf(const std::shared_ptr<const Skeleton>& skeleton,
                    const GoalKind& kind) {
  return IkProblem::Create(skeleton, {{"goal", 1, kind}}).value();
}

// Where one unit of motion turns an angle by many, differences say little: an
// aim at a near point, a twist beside a swing of half a turn.
bool IsSteep(const Linearized& at) {
  return at.jacobian.size() > 0 && at.jacobian.cwiseAbs().maxCoeff() > 3;
}

// The energy has a ridge where the shortest way turns round.
bool IsHalfTurn(const Linearized& at) {
  return at.rows.rotation_error2 > 4 - 1e-4;
}

bool IsPole(const IkProblem& problem) {
  return problem.targets()[0].shape == kernel::GoalShape::kPole;
}

class GoalRowsTest : public ::testing::TestWithParam<int> {};

// At any distance from the target, also at large angles.
TEST_P(GoalRowsTest, AreTheGradientOfTheEnergy) {
  Random random(GetParam() + 1);
  int compared = 0;
  for (int tree = 0; tree < 150; ++tree) {
    SkeletonRecipe recipe;
    recipe.joint_count = 4 + UniformIndex(random, 12);
    const auto skeleton = RandomSkeleton(random, recipe);
    if (skeleton->velocity_count() == 0) continue;
    const auto kind = RandomGoal(random, *skeleton, GetParam(),
                                 RandomPose(random, *skeleton));
    if (!kind) continue;
    const IkProblem problem = ProblemOf(skeleton, *kind);
    // Its bend fades, which the rows leave out on purpose; see below.
    if (IsPole(problem)) continue;
    const Eigen::VectorXd at = RandomPose(random, *skeleton);
    const Linearized linearized = LinearizeAt(problem, at);
    if (IsSteep(linearized) || IsHalfTurn(linearized)) continue;
    const Eigen::VectorXd want =
        Differences(*skeleton, at, [&](const Eigen::VectorXd& q) {
          return Eigen::VectorXd::Constant(
              1, Energy(problem, LinearizeAt(problem, q)));
        }).row(0);
    const Eigen::VectorXd got = Gradient(problem, linearized);
    EXPECT_LE((got - want).norm(), kDifferenceError * (1 + want.norm()))
        << GoalKindName(*kind) << " on tree " << tree;
    ++compared;
  }
  EXPECT_GT(compared, GetParam() == testing::kPoleGoal ? -1 : 100);
}

// At the target rows are the derivative of the residual itself.
TEST_P(GoalRowsTest, AreTheDerivativeAtTheTarget) {
  Random random(GetParam() + 101);
  for (int tree = 0; tree < 100; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    if (skeleton->velocity_count() == 0) continue;
    const Eigen::VectorXd truth = RandomPose(random, *skeleton);
    const auto kind = RandomGoal(random, *skeleton, GetParam(), truth);
    if (!kind || std::holds_alternative<HalfSpaceGoal>(*kind)) continue;
    const IkProblem problem = ProblemOf(skeleton, *kind);
    if (IsPole(problem)) continue;
    const Linearized at = LinearizeAt(problem, truth);
    EXPECT_LE(at.residual().norm(), 1e-7) << GoalKindName(*kind);
    const Eigen::MatrixXd want =
        -Differences(*skeleton, truth, [&](const Eigen::VectorXd& q) {
          return LinearizeAt(problem, q).residual();
        });
    EXPECT_LE((at.jacobian - want).norm(), kDifferenceError * (1 + want.norm()))
        << GoalKindName(*kind) << " on tree " << tree;
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKind, GoalRowsTest,
                         ::testing::Values(0, 1, 2, 3, 4, 7));

// The angle from the bend to the pole, by school geometry.
double PoleAngle(const Skeleton& skeleton, const Eigen::VectorXd& q,
                 const PoleGoal& pole) {
  WorldTransforms frames;
  ForwardKinematics(skeleton, q, frames);
  const auto origin = [&](const std::string& id) {
    return frames[skeleton.FindJoint(id)].translation;
  };
  const Eigen::Vector3d root = origin(pole.root_joint_id);
  const Eigen::Vector3d axis = (origin(pole.tip_joint_id) - root).normalized();
  const auto across = [&](const Eigen::Vector3d& point) {
    const Eigen::Vector3d arm = point - root;
    return Eigen::Vector3d(arm - axis * axis.dot(arm));
  };
  const Eigen::Vector3d bend = across(origin(pole.mid_joint_id));
  const Eigen::Vector3d to = across(pole.world_point);
  return std::atan2(axis.dot(bend.cross(to)), bend.dot(to));
}

TEST(PoleRowsTest, AreTheDerivativeOfTheAngle) {
  Random random(7);
  int compared = 0;
  for (int tree = 0; tree < 300; ++tree) {
    const auto skeleton = RandomSkeleton(random);
    const Eigen::VectorXd at = RandomPose(random, *skeleton);
    const auto kind = RandomGoal(random, *skeleton, testing::kPoleGoal, at);
    if (!kind) continue;
    PoleGoal pole = std::get<PoleGoal>(*kind);
    pole.world_point = RandomVector(random, 2);
    const Linearized got = LinearizeAt(ProblemOf(skeleton, pole), at);
    const double angle = PoleAngle(*skeleton, at, pole);
    const double fade = got.rows.residual[0] / (2 * std::sin(0.5 * angle));
    // A limb of no length, or one that no joint moves, has no bend.
    if (!(fade > 0.9) || std::abs(std::abs(angle) - M_PI) < 0.01) continue;
    const Eigen::VectorXd want =
        -Differences(*skeleton, at, [&](const Eigen::VectorXd& q) {
           return Eigen::VectorXd::Constant(1, PoleAngle(*skeleton, q, pole));
         }).row(0);
    const Eigen::VectorXd row = got.jacobian.row(0) / fade;
    EXPECT_LE((row - want).norm(), kDifferenceError * (1 + want.norm()))
        << "on tree " << tree;
    ++compared;
  }
  EXPECT_GT(compared, 100);
}

// How far the bend reaches towards the pole, of the limb's length.
TEST(PoleRowsTest, NudgeAStraightLimb) {
  SkeletonBuilder builder;
  for (int i = 0; i < 3; ++i) {
    Joint joint;
    joint.id = absl::StrCat("j", i);
    if (i > 0) joint.parent_id = absl::StrCat("j", i - 1);
    joint.type = JointType::kSpherical;
    if (i > 0) joint.parent_from_joint.translation = {0, 0, -0.4 - 0.1 * i};
    builder.AddJoint(joint);
  }
  const auto limb = builder.Build().value();
  const PoleGoal pole = {"j0", "j1", "j2", {0.3, 0, -0.2}};
  const IkProblem problem = ProblemOf(limb, pole);
  const Eigen::VectorXd straight = NeutralPositions(*limb);
  const Linearized got = LinearizeAt(problem, straight);
  EXPECT_EQ(got.rows.rotation_error2, 0);
  EXPECT_EQ(got.rows.residual[0], 0);
  EXPECT_GT(got.rows.residual[1], 0);
  const Eigen::MatrixXd want =
      -Differences(*limb, straight, [&](const Eigen::VectorXd& q) {
        return LinearizeAt(problem, q).residual();
      });
  EXPECT_LE((got.jacobian.row(1) - want.row(1)).norm(), kDifferenceError);
  EXPECT_GT(got.jacobian.row(1).norm(), 0.1);
}

}  // namespace
}  // namespace gelenk
