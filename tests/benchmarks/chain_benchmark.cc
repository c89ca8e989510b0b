// Chains that reach for points, from straight: the solver of IkSolver's default
// with limits and without, FABRIK without.
//
// Times are the mean over all targets, in turn; counters say how many of them
// were reached and in how many iterations on average.
#include <benchmark/benchmark.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/fabrik_solver.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "tests/benchmarks/chain_sets.h"

namespace gelenk::benchmarks {
namespace {

constexpr double kTolerance_m = 1e-5;

// `solve(problem, options, positions, report)` from the neutral pose.
template <typename Solve>
void SolveInTurn(benchmark::State& state, const ChainSet& set, Solve solve) {
  PositionGoal goal;
  goal.end_effector_id = "tip";
  IkProblem problem = *IkProblem::Create(set.skeleton, {{"tip", 1, goal}});
  SolverOptions options;
  options.position_tolerance_m = kTolerance_m;
  options.detail = ReportDetail::kBrief;
  const Eigen::VectorXd start = NeutralPositions(*set.skeleton);
  Eigen::VectorXd positions = start;
  SolveReport report;
  size_t at = 0;
  int64_t reached = 0;
  int64_t iterations = 0;
  for (auto _ : state) {
    problem.SetTarget(0, GoalTarget(set.targets[at]));
    at = (at + 1) % set.targets.size();
    positions = start;
    solve(problem, options, positions, report);
    reached += report.outcome == SolveOutcome::kConverged;
    iterations += report.iteration_count;
  }
  state.counters["solved_%"] = benchmark::Counter(
      100.0 * static_cast<double>(reached), benchmark::Counter::kAvgIterations);
  state.counters["iterations"] = benchmark::Counter(
      static_cast<double>(iterations), benchmark::Counter::kAvgIterations);
}

void SolveByDefault(benchmark::State& state, const ChainSet& set,
                    InstructionSet level) {
  LevenbergMarquardtSolver solver(level);
  SolveInTurn(state, set,
              [&](const IkProblem& problem, const SolverOptions& options,
                  Eigen::VectorXd& positions, SolveReport& report) {
                solver.Solve(problem, options, SolveStart::kCold, positions,
                             report);
              });
}

void SolveByFabrik(benchmark::State& state, const ChainSet& set) {
  FabrikSolver solver;
  SolveInTurn(state, set,
              [&](const IkProblem& problem, const SolverOptions& options,
                  Eigen::VectorXd& positions, SolveReport& report) {
                solver.Solve(problem, options, positions, report);
              });
}

int Register() {
  for (ChainKind kind :
       {ChainKind::kPlanar, ChainKind::kBall, ChainKind::kSpherical}) {
    for (int links : {3, 10, 50, 100}) {
      if (kind != ChainKind::kSpherical) {
        const auto& limited = *new ChainSet(MakeChainSet(kind, links, true));
        for (InstructionSet level : SupportedInstructionSets()) {
          benchmark::RegisterBenchmark(
              absl::StrCat(limited.name, "/limits/", InstructionSetName(level))
                  .c_str(),
              [&limited, level](benchmark::State& state) {
                SolveByDefault(state, limited, level);
              });
        }
      }
      const auto& free = *new ChainSet(MakeChainSet(kind, links, false));
      benchmark::RegisterBenchmark(
          absl::StrCat(free.name, "/free/default").c_str(),
          [&free](benchmark::State& state) {
            SolveByDefault(state, free, BestInstructionSet());
          });
      benchmark::RegisterBenchmark(
          absl::StrCat(free.name, "/free/fabrik").c_str(),
          [&free](benchmark::State& state) { SolveByFabrik(state, free); });
    }
  }
  return 0;
}

[[maybe_unused]] const int registered = Register();

}  // namespace
}  // namespace gelenk::benchmarks
