// Draws docs/live_hand.svg: hands at 72 Hz that go straight past the reach of
// three arms and come back, followed by gelenk and by plain damped least
// squares.
//
//   live_hand_plot > docs/live_hand.svg
//
// What the curves show is held by live_hand_test; here it can be seen.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/skeleton/pose.h"
#include "tests/benchmarks/ik/damped_least_squares.h"
#include "tests/benchmarks/ik/live_hand_chart.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/live_hands.h"

namespace gelenk::benchmarks {
namespace {

using testing::Hand;

// Out and as many back: ten seconds.
constexpr int kFramesOut = 360;
constexpr double kWay_m = 0.7;

// Moves the pose to follow a target.
using Follow = std::function<void(const Eigen::Vector3d&, VectorView)>;

HandRun Play(const Hand& hand, const Follow& follow) {
  const testing::WayOut way = WayOutOf(hand);
  HandRun run;
  Eigen::VectorXd positions = hand.start;
  Eigen::VectorXd change(hand.skeleton->velocity_count());
  for (int i = 1; i <= 2 * kFramesOut; ++i) {
    const int at = i <= kFramesOut ? i : 2 * kFramesOut - i;
    const Eigen::Vector3d target =
        way.from + at * kWay_m / kFramesOut * way.direction;
    const Eigen::VectorXd before = positions;
    follow(target, positions);
    Difference(*hand.skeleton, before, positions, change);
    run.steps_rad.push_back(change.cwiseAbs().maxCoeff());
    const RigidTransform tip =
        testing::EffectorPose(*hand.skeleton, positions, hand.tip());
    run.distances_m.push_back((tip.translation - target).norm());
  }
  return run;
}

HandRun PlayOurs(const Hand& hand, double max_step_rad) {
  IkProblem problem = *IkProblem::Create(
      hand.skeleton,
      {testing::PositionGoalFor(hand.tip(), Eigen::Vector3d::Zero())});
  SolverOptions options;
  options.position_tolerance_m = 1e-5;
  options.max_step = max_step_rad;
  IkSolver solver;
  SolveReport report;
  return Play(hand, [&](const Eigen::Vector3d& target, VectorView positions) {
    problem.SetTarget(0, target);
    solver.Solve(problem, options, SolveStart::kWarm, positions, report);
  });
}

HandRun PlayOther(const Hand& hand, const DampedLeastSquares& other) {
  return Play(hand, [&](const Eigen::Vector3d& target, VectorView positions) {
    other.Solve(*hand.skeleton, hand.tip(), target, positions);
  });
}

std::string Draw() {
  const DampedLeastSquares other;
  LiveHandLegend legend;
  legend.other =
      absl::StrCat("damped least squares: ", other.steps,
                   " steps a frame, damping ", other.damping, ", clamped");
  std::vector<HandFigures> figures;
  for (const Hand& hand : testing::LiveHands()) {
    figures.push_back({hand.name, PlayOurs(hand, legend.max_step_rad),
                       PlayOther(hand, other)});
  }
  return LiveHandChart(figures, legend);
}

}  // namespace
}  // namespace gelenk::benchmarks

int main() {
  const std::string picture = gelenk::benchmarks::Draw();
  std::fwrite(picture.data(), 1, picture.size(), stdout);
  return 0;
}
