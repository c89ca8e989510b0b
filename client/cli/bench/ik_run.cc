#include "client/cli/bench/ik_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>

#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk::cli {
namespace {

constexpr int kWarmUpProblems = 50;

using Clock = std::chrono::steady_clock;

double SolveOnce(const SolveProblem& solve, int problem,
                 Eigen::Ref<Eigen::VectorXd> positions) {
  const Clock::time_point begin = Clock::now();
  solve(problem, positions);
  return std::chrono::duration<double, std::micro>(Clock::now() - begin)
      .count();
}

double MedianOf(std::vector<double>& values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool Reaches(const IkSet& set, const Eigen::VectorXd& positions, int problem,
             double tolerance, WorldTransforms& frames) {
  ForwardKinematics(*set.skeleton, positions, frames);
  for (size_t g = 0; g < set.goals.size(); ++g) {
    const EffectorFrame tip =
        *set.skeleton->FindEffector(EffectorId(set.goals[g].kind));
    const RigidTransform reached = frames[tip.joint] * tip.joint_from_effector;
    const RigidTransform& target = set.target(problem, static_cast<int>(g));
    const double distance = (reached.translation - target.translation).norm();
    // So written that NaN is a miss.
    if (!(distance <= kAxisSlack * tolerance)) return false;
    if (set.goal == BenchGoal::kPose &&
        !(AngleBetween(reached.rotation, target.rotation) <=
          kAxisSlack * tolerance)) {
      return false;
    }
  }
  return true;
}

double LargestChange(const IkSet& set, const Eigen::VectorXd& from,
                     const Eigen::VectorXd& to) {
  Eigen::VectorXd change(set.skeleton->velocity_count());
  Difference(*set.skeleton, from, to, change);
  return change.size() == 0 ? 0 : change.cwiseAbs().maxCoeff();
}

}  // namespace

IkAnswers RunIkSet(const IkSet& set, const SolveProblem& solve, int passes,
                   const std::function<void(int)>& progress) {
  IkAnswers answers;
  answers.positions.resize(set.skeleton->position_count(), set.size());
  answers.durations_us.resize(set.size());
  for (int i = 0; i < std::min(kWarmUpProblems, set.size()); ++i) {
    answers.positions.col(i) = set.start(i);
    solve(i, answers.positions.col(i));
  }
  std::vector<double> times(passes);
  // Whole passes, so that no problem finds the branches of its own last solve
  // predicted.
  std::vector<std::vector<double>> durations(passes,
                                             std::vector<double>(set.size()));
  for (int pass = 0; pass < passes; ++pass) {
    for (int i = 0; i < set.size(); ++i) {
      answers.positions.col(i) = set.start(i);
      durations[pass][i] = SolveOnce(solve, i, answers.positions.col(i));
      if (progress && i % 256 == 0) progress(pass * set.size() + i);
    }
  }
  for (int i = 0; i < set.size(); ++i) {
    for (int pass = 0; pass < passes; ++pass) times[pass] = durations[pass][i];
    answers.durations_us[i] = MedianOf(times);
  }
  return answers;
}

IkAnswers RunIkBatch(const Eigen::MatrixXd& starts, const SolveBatch& solve,
                     int passes) {
  IkAnswers answers;
  std::vector<double> times(passes);
  for (int pass = -1; pass < passes; ++pass) {
    answers.positions = starts;
    const Clock::time_point begin = Clock::now();
    solve(answers.positions);
    if (pass < 0) continue;
    times[pass] =
        std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  }
  answers.durations_us.assign(
      starts.cols(),
      *std::min_element(times.begin(), times.end()) / starts.cols());
  return answers;
}

IkFigures JudgeIkAnswers(const IkSet& set, const IkAnswers& answers,
                         double tolerance) {
  IkFigures figures;
  figures.count = set.size();
  WorldTransforms frames;
  for (int i = 0; i < set.size(); ++i) {
    const Eigen::VectorXd positions = answers.positions.col(i);
    if (!Reaches(set, positions, i, tolerance, frames)) continue;
    if (LimitExcess(*set.skeleton, positions, nullptr) > kLimitSlack) {
      ++figures.outside_limits;
      continue;
    }
    ++figures.solved;
    if (LargestChange(set, set.start(i), positions) > kJump) ++figures.jumped;
  }
  std::vector<double> times = answers.durations_us;
  std::sort(times.begin(), times.end());
  if (times.empty()) return figures;
  figures.mean_us =
      std::accumulate(times.begin(), times.end(), 0.0) / times.size();
  figures.median_us = times[times.size() / 2];
  figures.p99_us = times[std::min(times.size() - 1, times.size() * 99 / 100)];
  return figures;
}

}  // namespace gelenk::cli
