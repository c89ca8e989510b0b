#include "gelenk/ik/newton_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/goal_equations.h"
#include "gelenk/ik/on_limit.h"
#include "gelenk/ik/solve_diagnosis.h"
#include "gelenk/math/pseudo_inverse.h"

namespace gelenk {
namespace {

// A step shorter than this, rad or m, leads nowhere: rounding of q is 1e-15.
constexpr double kNoStep = 1e-13;
// The null space's part of a step is not shortened below this.
constexpr double kLeastPull = 1.0 / 64;

Eigen::VectorXd StiffnessOf(const Skeleton& skeleton,
                            absl::Span<const int> unknowns) {
  Eigen::VectorXd all = Eigen::VectorXd::Ones(skeleton.velocity_count());
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const std::vector<double>& stiffness = skeleton.joint(i).stiffness;
    const int v = skeleton.span(i).velocity_offset;
    if (v < 0) continue;
    for (size_t k = 0; k < stiffness.size(); ++k) {
      all[v + static_cast<int>(k)] = stiffness[k];
    }
  }
  Eigen::VectorXd result(unknowns.size());
  for (size_t c = 0; c < unknowns.size(); ++c) {
    result[static_cast<int>(c)] = all[unknowns[c]];
  }
  return result;
}

// Its k-th velocity is that of its k-th number.
bool IsScalar(JointType type, int k) {
  return type != JointType::kSpherical && (type != JointType::kFree || k < 3);
}

// One solve.
class Iteration {
 public:
  Iteration(SolverMethod method, const IkProblem& problem,
            const SolverOptions& options, VectorView positions)
      : method_(method),
        skeleton_(problem.skeleton()),
        options_(options),
        equations_(problem),
        root_stiffness_(
            StiffnessOf(skeleton_, equations_.unknowns()).cwiseSqrt()),
        start_(positions),
        q_(positions),
        best_(positions) {
    ClampToLimits(skeleton_, q_);
    best_ = q_;
  }

  SolveOutcome Run(const StopCondition& stop, int& iterations) {
    for (iterations = 0;; ++iterations) {
      equations_.Evaluate(q_);
      Linearize();
      Record();
      if (HasConverged()) return SolveOutcome::kConverged;
      if (method_ == SolverMethod::kNewton && !IsInvertible()) {
        best_ = q_;  // the pose so far, be it the best or not
        return SolveOutcome::kSingular;
      }
      if (iterations >= options_.max_iterations) {
        return SolveOutcome::kIterationLimit;
      }
      if (stop()) return SolveOutcome::kTimeLimit;
      if (!Step()) return StationaryOutcome();
    }
  }

  // Brings everything to the answer.
  void Finish(VectorView positions) {
    q_ = best_;
    equations_.Evaluate(q_);
    Linearize();
    AlignHemispheres(skeleton_, start_, q_);
    positions = q_;
  }

  const GoalEquations& equations() const { return equations_; }
  double kkt_residual() const { return null_change_.norm(); }
  const Eigen::VectorXd& start() const { return start_; }

 private:
  // J^+, and what is left of the change in the null space, both in coordinates
  // in which the metric is the identity.
  void Linearize() {
    scaled_jacobian_ =
        equations_.jacobian() * root_stiffness_.cwiseInverse().asDiagonal();
    inverse_ = ComputePseudoInverse(scaled_jacobian_);
    Eigen::VectorXd back(skeleton_.velocity_count());
    Difference(skeleton_, q_, start_, back);
    Eigen::VectorXd unknown_back(root_stiffness_.size());
    for (int c = 0; c < unknown_back.size(); ++c) {
      unknown_back[c] = root_stiffness_[c] * back[equations_.unknowns()[c]];
    }
    null_change_ = method_ == SolverMethod::kMinimalChange
                       ? Eigen::VectorXd(unknown_back -
                                         inverse_.matrix *
                                             (scaled_jacobian_ * unknown_back))
                       : Eigen::VectorXd::Zero(unknown_back.size());
  }

  // Keeps the best pose and tells who asked.
  void Record() {
    const double residual = equations_.residual().norm();
    if (options_.iterates != nullptr) {
      options_.iterates->push_back({q_, residual});
    }
    // Within tolerance the shorter change is the better one.
    const bool reached = GoalsAreMet();
    const double rank = reached ? kkt_residual() : residual;
    if (reached > best_reached_ ||
        (reached == best_reached_ && rank <= best_rank_)) {
      best_ = q_;
      best_rank_ = rank;
      best_reached_ = reached;
    }
  }

  bool GoalsAreMet() const {
    const auto within = [](const std::vector<double>& errors, double most) {
      return std::all_of(errors.begin(), errors.end(),
                         [most](double error) { return error <= most; });
    };
    return within(equations_.position_errors_m(),
                  options_.position_tolerance_m) &&
           within(equations_.rotation_errors_rad(),
                  options_.rotation_tolerance_rad);
  }

  bool HasConverged() const {
    return GoalsAreMet() && kkt_residual() <= kKktTolerance;
  }

  bool IsInvertible() const {
    return scaled_jacobian_.rows() == scaled_jacobian_.cols() &&
           inverse_.rank == scaled_jacobian_.cols();
  }

  // False when it leads nowhere.
  bool Step() {
    if (kkt_residual() > last_kkt_) pull_ = std::max(pull_ / 2, kLeastPull);
    last_kkt_ = kkt_residual();
    Eigen::VectorXd velocity = Velocity(scaled_jacobian_, inverse_.matrix);
    // Hold what is at a bound and would leave, and ask again without it.
    Eigen::MatrixXd freed = scaled_jacobian_;
    while (Hold(velocity, freed)) {
      velocity = Velocity(freed, ComputePseudoInverse(freed).matrix);
    }
    if (!velocity.allFinite()) return false;
    const Eigen::VectorXd before = q_;
    Integrate(skeleton_, before, velocity, q_);
    ClampToLimits(skeleton_, q_);
    Difference(skeleton_, before, q_, velocity);
    return velocity.lpNorm<Eigen::Infinity>() > kNoStep;
  }

  // The step with pseudo-inverse `inverse` of `jacobian`, whose columns are
  // zero where an unknown is held.
  Eigen::VectorXd Velocity(const Eigen::MatrixXd& jacobian,
                           const Eigen::MatrixXd& inverse) const {
    const Eigen::VectorXd step =
        pull_ * null_change_ - inverse * equations_.residual();
    Eigen::VectorXd velocity =
        Eigen::VectorXd::Zero(skeleton_.velocity_count());
    for (int c = 0; c < step.size(); ++c) {
      if (IsHeld(jacobian, c)) continue;
      velocity[equations_.unknowns()[c]] = step[c] / root_stiffness_[c];
    }
    return velocity;
  }

  bool IsHeld(const Eigen::MatrixXd& jacobian, int c) const {
    return jacobian.col(c).isZero(0) && !scaled_jacobian_.col(c).isZero(0);
  }

  // Zeroes the column of the scalar coordinate that `velocity` moves fastest
  // out of its bounds, one at a time since without it others may turn round;
  // false when there is none.
  bool Hold(const Eigen::VectorXd& velocity, Eigen::MatrixXd& jacobian) const {
    const PositionBounds& bounds = skeleton_.position_bounds();
    int fastest = -1;
    double most = 0;
    int c = 0;
    for (int i : equations_.moving_joints()) {
      const JointSpan& span = skeleton_.span(i);
      const int end =
          span.velocity_offset + VelocityCount(skeleton_.joint(i).type);
      for (; c < jacobian.cols() && equations_.unknowns()[c] < end; ++c) {
        const int k = equations_.unknowns()[c] - span.velocity_offset;
        if (!IsScalar(skeleton_.joint(i).type, k)) continue;
        const int q = span.position_offset + k;
        const double v = velocity[equations_.unknowns()[c]];
        const bool leaves = (v < 0 && q_[q] <= bounds.lower[q]) ||
                            (v > 0 && q_[q] >= bounds.upper[q]);
        if (!leaves || std::abs(v) <= most || jacobian.col(c).isZero(0)) {
          continue;
        }
        most = std::abs(v);
        fastest = c;
      }
    }
    if (fastest >= 0) jacobian.col(fastest).setZero();
    return fastest >= 0;
  }

  SolveOutcome StationaryOutcome() const {
    for (int i : equations_.moving_joints()) {
      if (IsOnLimit(skeleton_, i, best_)) return SolveOutcome::kStalledAtLimits;
    }
    // Met to rounding, with a tolerance below that.
    return SolveOutcome::kUnreachable;
  }

  const SolverMethod method_;
  const Skeleton& skeleton_;
  const SolverOptions& options_;
  GoalEquations equations_;
  const Eigen::VectorXd root_stiffness_;
  const Eigen::VectorXd start_;
  Eigen::VectorXd q_;
  Eigen::VectorXd best_;
  bool best_reached_ = false;
  double best_rank_ = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd scaled_jacobian_;
  PseudoInverse inverse_;
  Eigen::VectorXd null_change_;
  double pull_ = 1;
  double last_kkt_ = std::numeric_limits<double>::infinity();
};

}  // namespace

absl::Status NewtonSolver::Check(const IkProblem& problem,
                                 SolverMethod method) {
  Violations violations;
  if (!GoalEquations::Fit(problem)) {
    violations.Add("method",
                   absl::StrCat(SolverMethodName(method),
                                " takes position, rotation and pose goals"));
    return violations.ToStatus();
  }
  if (problem.needs_levels()) {
    violations.Add("method", absl::StrCat(SolverMethodName(method),
                                          " takes goals of one priority"));
    return violations.ToStatus();
  }
  if (method != SolverMethod::kNewton) return absl::OkStatus();
  const GoalEquations equations(problem);
  const int unknowns = static_cast<int>(equations.unknowns().size());
  if (equations.declared_row_count() != unknowns) {
    violations.Add(
        "method",
        absl::StrFormat("newton wants as many equations as unknowns, got %d "
                        "equations and %d unknowns",
                        equations.declared_row_count(), unknowns));
  }
  return violations.ToStatus();
}

void NewtonSolver::Solve(const IkProblem& problem, const SolverOptions& options,
                         VectorView positions, SolveReport& report,
                         const StopCondition& stop) {
  if (options.iterates != nullptr) options.iterates->clear();
  Iteration iteration(method_, problem, options, positions);
  report.method = method_;
  report.restart_count = 0;
  report.outcome = iteration.Run(stop, report.iteration_count);
  iteration.Finish(positions);
  report.position_errors_m = iteration.equations().position_errors_m();
  report.rotation_errors_rad = iteration.equations().rotation_errors_rad();
  report.kkt_residual = iteration.kkt_residual();
  report.limited_joints.clear();
  report.change = 0;
  if (options.detail == ReportDetail::kBrief) return;
  for (int i : iteration.equations().moving_joints()) {
    if (IsOnLimit(problem.skeleton(), i, positions)) {
      report.limited_joints.push_back(i);
    }
  }
  Eigen::VectorXd change(problem.skeleton().velocity_count());
  report.change = WeightedChange(problem, iteration.start(), positions, change);
  if (options.detail == ReportDetail::kDiagnosis) {
    Diagnose(problem, positions, report);
  }
}

}  // namespace gelenk
