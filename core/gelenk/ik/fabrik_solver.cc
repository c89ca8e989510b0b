#include "gelenk/ik/fabrik_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "gelenk/ik/solve_diagnosis.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// Points this near to a line, by the length of the chain, are on it.
constexpr double kOnLine = 1e-4;
// How far a chain on a line is bowed, by its length.
constexpr double kBow = 0.1;
// Points are reached by so much more than asked for that the joints, too, are
// there after rounding.
constexpr double kRounding = 1e-6;

// Moves `from` to `length` from `to` along the line between them.
void Pull(const Vector3d& to, double length, const Vector3d& aside,
          Vector3d& from) {
  Vector3d way = from - to;
  double distance2 = way.squaredNorm();
  if (distance2 == 0) {
    way = aside;
    distance2 = 1;
  }
  from = to + (length / std::sqrt(distance2)) * way;
}

}  // namespace

absl::Status FabrikSolver::Check(const IkProblem& problem) {
  if (problem.goals().size() != 1) {
    return absl::InvalidArgumentError("goals: want one position");
  }
  const auto* position = std::get_if<PositionGoal>(&problem.goals()[0].kind);
  const bool whole = position != nullptr && position->axes.x &&
                     position->axes.y && position->axes.z;
  if (!whole) {
    return absl::InvalidArgumentError(
        "goals[0]: want a position along all axes");
  }
  return BoneChain::Of(problem.skeleton(), problem.tree().Layout(),
                       problem.tree().joints_of_nodes())
      .status();
}

void FabrikSolver::Bend(const Vector3d& last, const Vector3d& aside,
                        double length) {
  // Right on the root there is no line but that of the points.
  const Vector3d way = last - points_[0];
  const Vector3d direction =
      way.norm() > kOnLine * length
          ? way.normalized()
          : Vector3d((points_[1] - points_[0]).normalized());
  for (const Vector3d& point : points_) {
    if ((point - points_[0]).cross(direction).norm() > kOnLine * length) return;
  }
  const double step = std::numbers::pi / static_cast<double>(points_.size());
  for (size_t k = 1; k + 1 < points_.size(); ++k) {
    points_[k] +=
        kBow * length * std::sin(step * static_cast<double>(k)) * aside;
  }
}

int FabrikSolver::Sweep(absl::Span<const double> lengths, const Vector3d& last,
                        const Vector3d& aside, double tolerance, int most) {
  const size_t n = lengths.size();
  const Vector3d root = points_[0];
  int sweeps = 0;
  for (; sweeps < most; ++sweeps) {
    if ((points_[n] - last).norm() <= tolerance) break;
    points_[n] = last;
    for (size_t k = n; k > 0; --k) {
      Pull(points_[k], lengths[k - 1], aside, points_[k - 1]);
    }
    points_[0] = root;
    for (size_t k = 0; k < n; ++k) {
      Pull(points_[k], lengths[k], aside, points_[k + 1]);
    }
  }
  return sweeps;
}

void FabrikSolver::Solve(const IkProblem& problem, const SolverOptions& options,
                         VectorView positions, SolveReport& report) {
  const BoneChain& bones = *problem.tree().bones();
  const RigidTransform& base = problem.world_from_skeleton();
  const kernel::TaskTarget& goal = problem.targets()[0];
  const Vector3d target(goal.world_translation[0], goal.world_translation[1],
                        goal.world_translation[2]);
  start_ = positions;
  ClampToLimits(problem.skeleton(), positions);
  report.outcome = SolveOutcome::kConverged;
  report.iteration_count = 0;
  report.restart_count = 0;
  report.position_errors_m.assign(1, 0);
  report.rotation_errors_rad.assign(1, 0);
  if (goal.active) {
    points_.resize(bones.bone_count() + 1);
    bones.ComputePoints(positions, base, absl::MakeSpan(points_), turns_);
    const Vector3d last = bones.LastPointFor(base, target);
    // What lies across the plane cannot be helped.
    const double across = (target - last).norm();
    const double tolerance = options.position_tolerance_m;
    const bool out_of_plane = across > tolerance;
    const double left =
        out_of_plane ? tolerance
                     : std::sqrt(tolerance * tolerance - across * across);
    const bool out_of_reach = bones.ReachOut(last, absl::MakeSpan(points_));
    if (!out_of_reach) {
      const Vector3d aside = bones.AnyAcross(base, last - points_[0]);
      Bend(last, aside, bones.reach().longest);
      report.iteration_count =
          Sweep(bones.lengths(), last, aside, (1 - kRounding) * left,
                kSweepsPerIteration * options.max_iterations);
    }
    const Vector3d tip = bones.Follow(points_, base, turns_, positions);
    report.position_errors_m[0] = (tip - target).norm();
    if (!(report.position_errors_m[0] <= tolerance)) {
      report.outcome = out_of_plane || out_of_reach
                           ? SolveOutcome::kUnreachable
                           : SolveOutcome::kIterationLimit;
    }
  }
  AlignHemispheres(problem.skeleton(), start_, positions);
  FinishReport(problem, options, positions, report);
}

void FabrikSolver::FinishReport(const IkProblem& problem,
                                const SolverOptions& options,
                                const ConstVectorView& positions,
                                SolveReport& report) {
  report.limited_joints.clear();
  report.change = 0;
  if (options.detail == ReportDetail::kBrief) return;
  change_.resize(problem.skeleton().velocity_count());
  report.change = WeightedChange(problem, start_, positions, change_);
  if (options.detail == ReportDetail::kDiagnosis) {
    Diagnose(problem, positions, report);
  }
}

}  // namespace gelenk
