#include "gelenk/ik/levenberg_marquardt_solver.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>

#include "gelenk/ik/half_space_overshoot.h"
#include "gelenk/ik/kernel/rotation_bounds.h"
#include "gelenk/ik/kernel_exchange.h"
#include "gelenk/ik/posture_terms.h"
#include "gelenk/ik/serial_arm.h"
#include "gelenk/ik/solve_arm.h"
#include "gelenk/ik/solve_diagnosis.h"
#include "gelenk/ik/start_sampler.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

// A coordinate this near to its bound is on it.
constexpr double kOnBound = 1e-9;

// Iterations of the last attempt against those of the others.
constexpr int kPolishFactor = 4;

// Beyond its plane by no more than this a point may stay that was behind it.
constexpr double kMostOvershoot_m = 1e-3;

kernel::AttemptFunction AttemptFor(InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) return kernel::avx2::Run;
  if (level == InstructionSet::kAvx512) return kernel::avx512::Run;
#endif
  return kernel::baseline::Run;
}

kernel::ChainFunction ChainFunctionFor(InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) return kernel::avx2::RunChain;
  if (level == InstructionSet::kAvx512) return kernel::avx512::RunChain;
#endif
  return kernel::baseline::RunChain;
}

// Cuts aligned pieces off one block of memory; first without memory, to count.
class Carver {
 public:
  explicit Carver(double* memory) : memory_(memory) {}

  double* Doubles(int count) {
    double* piece = memory_ == nullptr ? nullptr : memory_ + used_;
    used_ += kernel::PaddedRow(count);
    return piece;
  }
  uint8_t* Bytes(int count) { return Objects<uint8_t>(count); }
  // Plain ones, not initialised.
  template <class Object>
  Object* Objects(int count) {
    return reinterpret_cast<Object*>(Doubles(static_cast<int>(
        (count * sizeof(Object) + sizeof(double) - 1) / sizeof(double))));
  }
  size_t used() const { return used_; }

 private:
  double* memory_;
  size_t used_ = 0;
};

// What the kernel of chains needs: no matrix of columns by columns.
kernel::ChainWorkspace CarveChain(const kernel::TreeLayout& tree,
                                  const kernel::ChainLayout& chain,
                                  Carver& carver) {
  kernel::ChainWorkspace w = {};
  w.records = carver.Doubles(kernel::kChainLanes * chain.record_size);
  w.touched = carver.Bytes(tree.node_count);
  w.position_error2 = carver.Doubles(1);
  return w;
}

kernel::Workspace Carve(const kernel::TreeLayout& tree, Carver& carver) {
  kernel::Workspace w = {};
  w.node_rotation = carver.Doubles(9 * tree.node_count);
  w.node_translation = carver.Doubles(3 * tree.node_count);
  w.axes = carver.Doubles(3 * tree.axis_count);
  w.body_bases = carver.Doubles(9 * tree.node_count);
  w.touched = carver.Bytes(tree.node_count);
  w.jacobian = carver.Doubles(tree.j_size);
  w.residuals = carver.Doubles(6 * tree.task_count);
  w.effectors = carver.Doubles(3 * tree.task_count);
  w.frames = carver.Objects<kernel::GoalFrame>(kernel::kMaxGoalFrames *
                                               tree.shaped_count);
  w.goal_rows = carver.Objects<kernel::GoalRows>(tree.shaped_count);
  w.h = carver.Doubles(tree.h_size);
  w.gradient = carver.Doubles(tree.column_count);
  w.step = carver.Doubles(tree.column_count);
  w.blocked = carver.Bytes(tree.column_count);
  w.best_positions = carver.Doubles(tree.position_count);
  w.position_errors2 = carver.Doubles(tree.task_count);
  w.rotation_errors2 = carver.Doubles(tree.task_count);
  return w;
}

// By its own limits or those of a joint that moves along.
bool IsOnLimit(const Skeleton& skeleton, int j,
               const ConstVectorView& positions) {
  const PositionBounds& bounds = skeleton.position_bounds();
  const int mimicked = skeleton.span(j).mimicked;
  const int owner = mimicked < 0 ? j : mimicked;
  const int begin = skeleton.span(owner).position_offset;
  const int end = begin + PositionCount(skeleton.joint(owner).type);
  for (int q = begin; q < end; ++q) {
    if (positions[q] <= bounds.lower[q] + kOnBound ||
        positions[q] >= bounds.upper[q] - kOnBound) {
      return true;
    }
  }
  return false;
}

// An arm that the kernels of arms do not take: one of its joints mimics
// another, or a limit is no number for them.
bool IsOtherArm(const kernel::TreeLayout& tree) {
  return tree.task_count == 1 &&
         tree.tasks[0].shape == kernel::GoalShape::kPose &&
         tree.tasks[0].row_end - tree.tasks[0].row_begin == 6 &&
         tree.column_count <= kernel::kMaxArmJoints;
}

using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;

ConstVectorMap View(const std::vector<double>& numbers) {
  return ConstVectorMap(numbers.data(), numbers.size());
}

}  // namespace

LevenbergMarquardtSolver::LevenbergMarquardtSolver(InstructionSet level)
    : level_(level),
      attempt_(AttemptFor(level)),
      arm_kernel_(ArmKernelFor(level)),
      run_chain_(ChainFunctionFor(level)) {}

void LevenbergMarquardtSolver::Reserve(const IkProblem& problem,
                                       const kernel::TreeLayout& tree) {
  const SerialChain* chain = chain_;
  const auto carve = [&](Carver& carver) {
    if (chain == nullptr) {
      workspace_ = Carve(tree, carver);
      return;
    }
    chain_workspace_ = CarveChain(tree, chain->Layout(), carver);
    // What the report reads.
    workspace_.touched = chain_workspace_.touched;
    workspace_.position_errors2 = chain_workspace_.position_error2;
    workspace_.rotation_errors2 = carver.Doubles(1);
  };
  Carver count(nullptr);
  carve(count);
  const size_t wanted = count.used() + kernel::kRowAlignment;
  if (memory_.size() < wanted) memory_.resize(wanted);
  // Whole cache lines: rows of J and H start on vector boundaries.
  void* aligned = memory_.data();
  size_t space = memory_.size() * sizeof(double);
  std::align(kernel::kRowAlignment * sizeof(double),
             count.used() * sizeof(double), aligned, space);
  Carver carver(static_cast<double*>(aligned));
  carve(carver);
  if (chain == nullptr) {
    // The padding of J's rows is read, never written.
    std::fill(workspace_.jacobian,
              workspace_.jacobian + kernel::PaddedRow(tree.j_size), 0.0);
  } else {
    workspace_.rotation_errors2[0] = 0;
  }
  start_.resize(problem.skeleton().position_count());
}

kernel::Attempt LevenbergMarquardtSolver::Run(const IkProblem& problem,
                                              const kernel::TreeLayout& tree,
                                              const kernel::Settings& settings,
                                              VectorView positions) {
  if (chain_ != nullptr) {
    return run_chain_(chain_->Layout(), problem.targets()[0], settings,
                      chain_workspace_, positions.data());
  }
  const kernel::TaskTarget* targets =
      problem.has_free_plants() ? targets_.data() : problem.targets().data();
  return attempt_(tree, targets, settings, workspace_, positions.data());
}

bool LevenbergMarquardtSolver::ReachOut(const IkProblem& problem,
                                        const kernel::TreeLayout& tree,
                                        kernel::Settings settings,
                                        VectorView positions,
                                        kernel::Attempt& attempt) {
  const BoneChain* bones = problem.tree().bones();
  const bool narrowed = settings.lower != tree.lower;
  if (bones == nullptr || chain_ == nullptr || narrowed) return false;
  const kernel::TaskTarget& target = problem.targets()[0];
  const double* counts = target.row_counts;
  const bool whole = counts[0] > 0 && counts[1] > 0 && counts[2] > 0;
  if (!target.active || !whole) return false;
  const RigidTransform& base = problem.world_from_skeleton();
  const double* t = target.world_translation;
  const Eigen::Vector3d last = bones->LastPointFor(base, {t[0], t[1], t[2]});
  if (bones->Reaches(base, last)) return false;
  bones->ComputePose(positions, base, bone_pose_);
  bones->ReachOut(last, bone_pose_);
  bones->Follow(bone_pose_, base, positions);
  // Only to see how far that is.
  settings.max_iterations = 0;
  attempt = Run(problem, tree, settings, positions);
  if (attempt.end != kernel::AttemptEnd::kConverged) {
    attempt.end = kernel::AttemptEnd::kStationary;
  }
  return true;
}

void LevenbergMarquardtSolver::Solve(const IkProblem& problem,
                                     const SolverOptions& options,
                                     SolveStart start, VectorView positions,
                                     SolveReport& report,
                                     const StopCondition& stop,
                                     const StepBounds* bounds) {
  if (problem.needs_levels()) {
    prioritized_.Solve(problem, options, start, positions, report, stop,
                       bounds);
    return;
  }
  SolveAtOnce(problem, options, start, positions, report, stop, bounds);
  if (report.outcome != SolveOutcome::kConverged ||
      HalfSpaceOvershoot(problem, View(start_), positions) <=
          kMostOvershoot_m) {
    return;
  }
  const int iterations = report.iteration_count;
  positions = View(start_);
  prioritized_.Solve(problem, options, start, positions, report, stop, bounds);
  report.iteration_count += iterations;
}

void LevenbergMarquardtSolver::SolveAtOnce(
    const IkProblem& problem, const SolverOptions& options, SolveStart start,
    VectorView positions, SolveReport& report, const StopCondition& stop,
    const StepBounds* bounds) {
  const bool bounded = start == SolveStart::kWarm &&
                       (options.max_step.has_value() || bounds != nullptr);
  const auto narrow = [&](const kernel::TreeLayout& tree,
                          kernel::Settings& settings) {
    if (!bounded) return;
    bounds_.Narrow(problem, tree, options.max_step, bounds, positions,
                   settings);
  };
  const SerialArm* arm = problem.arm();
  if (arm != nullptr && SolveAsArm(problem, *arm, options, start, positions,
                                   report, stop, narrow)) {
    return;
  }
  const kernel::TreeLayout tree = problem.tree().Layout();
  const Skeleton& skeleton = problem.skeleton();
  // The kernel of chains knows no bounds of turns, and no free plants.
  const SerialChain* chain = problem.tree().chain();
  const bool fits = chain != nullptr && !problem.has_free_plants() &&
                    !(bounded && chain->has_spherical());
  chain_ = fits ? chain : nullptr;
  Reserve(problem, tree);
  std::copy(positions.begin(), positions.end(), start_.begin());
  if (problem.has_free_plants()) problem.CopyTargets(positions, targets_);
  TakePosture(problem.outside_posture(), positions);
  ClampToLimits(skeleton, positions);

  kernel::Settings settings = SettingsFor(problem, tree, options, stop);
  narrow(tree, settings);
  // Starts from elsewhere would be out of bounds.
  const int budget = bounded            ? 0
                     : IsOtherArm(tree) ? ArmRestartBudget(options, start)
                                        : RestartBudget(options, start);
  settings.impatient = budget > 0;
  kernel::Attempt attempt;
  const bool reached_out =
      ReachOut(problem, tree, settings, positions, attempt);
  if (!reached_out) attempt = Run(problem, tree, settings, positions);
  report.iteration_count = attempt.iterations;
  report.restart_count = 0;
  if (!reached_out && attempt.end != kernel::AttemptEnd::kConverged &&
      attempt.end != kernel::AttemptEnd::kStopped && budget > 0) {
    attempt = Restart(problem, settings, budget, options.restart_seed, attempt,
                      positions, report);
  }
  AlignHemispheres(skeleton, View(start_), positions);
  report.outcome = OutcomeOf(attempt.end, attempt.pushed_at_limit);
  report.position_errors_m.resize(tree.task_count);
  report.rotation_errors_rad.resize(tree.task_count);
  for (int t = 0; t < tree.task_count; ++t) {
    ReportErrors(t, workspace_.position_errors2[t],
                 workspace_.rotation_errors2[t], report);
  }
  ReportDetails(problem, options, tree, positions, report);
}

bool LevenbergMarquardtSolver::SolveAsArm(
    const IkProblem& problem, const SerialArm& arm,
    const SolverOptions& options, SolveStart start, VectorView positions,
    SolveReport& report, const StopCondition& stop, const Narrow& narrow) {
  const kernel::TreeLayout tree = problem.tree().Layout();
  start_.assign(positions.begin(), positions.end());
  ClampToLimits(problem.skeleton(), positions);
  kernel::ArmRow q;
  arm.Gather(positions, q);
  if (!arm.Takes(q)) {
    positions = View(start_);
    return false;
  }
  kernel::ArmSettings settings;
  kernel::ArmTarget target;
  kernel::Settings tree_settings = SettingsFor(problem, tree, options, stop);
  narrow(tree, tree_settings);
  arm.Prepare(tree_settings, problem.targets()[0], settings);
  arm.Prepare(problem.targets()[0], target);
  const ArmRequest request = {arm,
                              settings,
                              {tree.lower, size_t(tree.node_count)},
                              {tree.upper, size_t(tree.node_count)},
                              start,
                              ArmRestartBudget(options, start),
                              options.restart_seed};
  const kernel::ArmAttempt attempt = SolveArm(arm_kernel_, request, target, q);
  arm.Scatter(q, positions);
  report.outcome = OutcomeOf(attempt.end, attempt.pushed_at_limit);
  report.iteration_count = attempt.iterations;
  report.restart_count = attempt.drawn;
  report.position_errors_m.resize(1);
  report.rotation_errors_rad.resize(1);
  ReportErrors(0, attempt.errors.position2, attempt.errors.rotation2, report);
  ReportDetails(problem, options, tree, positions, report);
  return true;
}

void LevenbergMarquardtSolver::FindMovingJoints(
    const IkProblem& problem, const kernel::TreeLayout& tree) {
  moves_.assign(problem.skeleton().joint_count(), 0);
  for (int t = 0; t < tree.task_count; ++t) {
    if (!problem.targets()[t].active) continue;
    const kernel::Task& task = tree.tasks[t];
    const kernel::PathColumn* path = tree.path_columns + task.path_begin;
    const auto mark = [&](int place) {
      moves_[problem.tree().joint_of_column(path[place].column)] = 1;
    };
    for (int k = 0; k < task.path_size; ++k) {
      if (!path[k].absent) mark(k);
    }
    for (int f = 0; f < task.follower_count; ++f) {
      mark(tree.followers[task.follower_begin + f].place);
    }
  }
  moving_joints_.clear();
  for (size_t j = 0; j < moves_.size(); ++j) {
    if (moves_[j] != 0) moving_joints_.push_back(static_cast<int>(j));
  }
}

kernel::Attempt LevenbergMarquardtSolver::Restart(const IkProblem& problem,
                                                  kernel::Settings settings,
                                                  int budget, int64_t seed,
                                                  kernel::Attempt attempt,
                                                  VectorView positions,
                                                  SolveReport& report) {
  const kernel::TreeLayout tree = problem.tree().Layout();
  const auto run = [&] {
    attempt = Run(problem, tree, settings, positions);
    report.iteration_count += attempt.iterations;
  };
  FindMovingJoints(problem, tree);
  StartSampler sampler(seed);
  best_.assign(positions.begin(), positions.end());
  double best_energy = attempt.energy;
  while (attempt.end != kernel::AttemptEnd::kConverged &&
         attempt.end != kernel::AttemptEnd::kStopped &&
         report.restart_count < budget) {
    ++report.restart_count;
    sampler.Sample(problem.skeleton(), moving_joints_, View(start_), positions);
    run();
    if (attempt.energy < best_energy) {
      best_energy = attempt.energy;
      best_.assign(positions.begin(), positions.end());
    }
  }
  if (attempt.end != kernel::AttemptEnd::kConverged) {
    // Nothing reached: finish the best attempt with patience, so that it says
    // whether the target is out of reach. Who was told to stop stops here
    // again, at once.
    positions = View(best_);
    settings.impatient = false;
    settings.max_iterations *= kPolishFactor;
    run();
  }
  return attempt;
}

void LevenbergMarquardtSolver::ReportErrors(int t, double position2,
                                            double rotation2,
                                            SolveReport& report) {
  report.position_errors_m[t] = std::sqrt(position2);
  report.rotation_errors_rad[t] = AngleOf(rotation2);
}

void LevenbergMarquardtSolver::ReportDetails(const IkProblem& problem,
                                             const SolverOptions& options,
                                             const kernel::TreeLayout& tree,
                                             const ConstVectorView& positions,
                                             SolveReport& report) {
  report.limited_joints.clear();
  report.limited_joints.reserve(tree.node_count);
  report.change = 0;
  if (options.detail == ReportDetail::kBrief) return;

  const Skeleton& skeleton = problem.skeleton();
  for (int n = 0; n < tree.node_count; ++n) {
    const int joint = problem.tree().joint_of(n);
    const kernel::Node& node = tree.nodes[n];
    const bool turns = node.type == kernel::NodeType::kSpherical ||
                       node.type == kernel::NodeType::kFree;
    // `touched` is that of the last forward pass, which was at the result.
    if ((turns && workspace_.touched[n] != 0) ||
        IsOnLimit(skeleton, joint, positions)) {
      report.limited_joints.push_back(joint);
    }
  }
  change_.resize(skeleton.velocity_count());
  report.change = WeightedChange(
      problem, View(start_), positions,
      Eigen::Map<Eigen::VectorXd>(change_.data(), change_.size()));
  if (options.detail == ReportDetail::kDiagnosis) {
    Diagnose(problem, positions, report);
  }
}

}  // namespace gelenk
