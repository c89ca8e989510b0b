// Warm solves of a standing body, with the same goals at one level and at three
// (see StandingProblem).
//
// Each iteration solves one frame of a smooth motion from the frame before; the
// counters are what the iterations of the solver took on average, and how far
// the feet came from their place at worst, in nm.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "tests/benchmarks/problems.h"

namespace gelenk::benchmarks {
namespace {

constexpr int kFrames = 600;

void SolveStanding(benchmark::State& state, bool priorities) {
  const StreamProblem stream = StandingProblem(kFrames, priorities);
  IkProblem problem = *IkProblem::Create(stream.skeleton, stream.goals);
  IkSolver solver;
  SolverOptions options;
  options.detail = ReportDetail::kBrief;
  Eigen::VectorXd positions = stream.start;
  SolveReport report;
  int64_t iterations = 0;
  int64_t missed = 0;
  double worst_m = 0;
  size_t frame = 0;
  // Back and forth, so that no step is larger than a frame's.
  const size_t period = 2 * (stream.frames.size() - 1);
  for (auto _ : state) {
    frame = (frame + 1) % period;
    const size_t at = frame < stream.frames.size() ? frame : period - frame;
    for (size_t g = 2; g < 4; ++g) {
      problem.SetTarget(static_cast<int>(g), stream.frames[at][g]);
    }
    solver.Solve(problem, options, SolveStart::kWarm, positions, report);
    iterations += report.iteration_count;
    missed += report.outcome != SolveOutcome::kConverged;
    worst_m = std::max(
        {worst_m, report.position_errors_m[0], report.position_errors_m[1]});
  }
  state.counters["iterations"] = benchmark::Counter(
      static_cast<double>(iterations), benchmark::Counter::kAvgIterations);
  state.counters["missed"] = static_cast<double>(missed);
  state.counters["feet_nm"] = 1e9 * worst_m;
}

BENCHMARK_CAPTURE(SolveStanding, one_level, false);
BENCHMARK_CAPTURE(SolveStanding, three_levels, true);

}  // namespace
}  // namespace gelenk::benchmarks
