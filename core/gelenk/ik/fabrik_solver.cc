#include "gelenk/ik/fabrik_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
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

absl::Status Fits(const IkProblem& problem) {
  if (problem.goals().size() != 1) {
    return absl::InvalidArgumentError("want one goal");
  }
  const auto* position = std::get_if<PositionGoal>(&problem.goals()[0].kind);
  const bool whole = position != nullptr && position->axes.x &&
                     position->axes.y && position->axes.z;
  if (!whole) {
    return absl::InvalidArgumentError("want a position goal, along all axes");
  }
  return BoneChain::Of(problem.skeleton(), problem.tree().Layout(),
                       problem.tree().joints_of_nodes())
      .status();
}

}  // namespace

absl::Status FabrikSolver::Check(const IkProblem& problem) {
  const absl::Status fits = Fits(problem);
  if (fits.ok()) return fits;
  Violations violations;
  violations.Add("method", absl::StrCat("fabrik: ", fits.message()));
  return violations.ToStatus();
}

void FabrikSolver::Bend(const Vector3d& direction, const Vector3d& aside,
                        double length) {
  std::vector<Vector3d>& points = pose_.points;
  for (const Vector3d& point : points) {
    if ((point - points[0]).cross(direction).norm() > kOnLine * length) return;
  }
  const double step = std::numbers::pi / static_cast<double>(points.size());
  for (size_t k = 1; k + 1 < points.size(); ++k) {
    points[k] +=
        kBow * length * std::sin(step * static_cast<double>(k)) * aside;
  }
}

void FabrikSolver::Sweep(absl::Span<const double> lengths, const Vector3d& last,
                         const Vector3d& aside) {
  std::vector<Vector3d>& points = pose_.points;
  const size_t n = lengths.size();
  const Vector3d root = points[0];
  points[n] = last;
  for (size_t k = n; k > 0; --k) {
    Pull(points[k], lengths[k - 1], aside, points[k - 1]);
  }
  points[0] = root;
  for (size_t k = 0; k < n; ++k) {
    Pull(points[k], lengths[k], aside, points[k + 1]);
  }
}

void FabrikSolver::Solve(const IkProblem& problem, const SolverOptions& options,
                         VectorView positions, SolveReport& report,
                         const StopCondition& stop) {
  report.outcome = SolveOutcome::kConverged;
  report.iteration_count = 0;
  report.restart_count = 0;
  report.position_errors_m.assign(1, 0);
  report.rotation_errors_rad.assign(1, 0);
  start_ = positions;
  ClampToLimits(problem.skeleton(), positions);
  if (problem.targets()[0].active) {
    Reach(problem, options, positions, report, stop);
  }
  AlignHemispheres(problem.skeleton(), start_, positions);
  FinishReport(problem, options, positions, report);
}

void FabrikSolver::Reach(const IkProblem& problem, const SolverOptions& options,
                         VectorView positions, SolveReport& report,
                         const StopCondition& stop) {
  const BoneChain& bones = *problem.tree().bones();
  const RigidTransform& base = problem.world_from_skeleton();
  const double* t = problem.targets()[0].world_translation;
  const Vector3d target(t[0], t[1], t[2]);
  const double tolerance = options.position_tolerance_m;
  bones.ComputePose(positions, base, pose_);
  const Vector3d last = bones.LastPointFor(base, target);
  // What lies across the plane cannot be helped.
  const double across = (target - last).norm();
  bool unreachable = across > tolerance;
  const double left = unreachable
                          ? tolerance
                          : std::sqrt(tolerance * tolerance - across * across);
  SolveOutcome missed = SolveOutcome::kIterationLimit;
  if (!bones.Reaches(base, last)) {
    unreachable = true;
    bones.ReachOut(last, pose_);
  } else {
    // Right on the root there is no line but that of the points.
    const double length = bones.total_length();
    Vector3d way = last - pose_.points[0];
    if (way.norm() <= kOnLine * length) way = pose_.points[1] - pose_.points[0];
    const Vector3d aside = bones.AnyAcross(base, way);
    Bend(way.normalized(), aside, length);
    const int most = kSweepsPerIteration * options.max_iterations;
    while ((pose_.points.back() - last).norm() > (1 - kRounding) * left &&
           report.iteration_count < most) {
      if (stop()) {
        missed = SolveOutcome::kTimeLimit;
        break;
      }
      Sweep(bones.lengths(), last, aside);
      ++report.iteration_count;
    }
  }
  const Vector3d tip = bones.Follow(pose_, base, positions);
  report.position_errors_m[0] = (tip - target).norm();
  if (report.position_errors_m[0] <= tolerance) return;
  report.outcome = unreachable ? SolveOutcome::kUnreachable : missed;
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
