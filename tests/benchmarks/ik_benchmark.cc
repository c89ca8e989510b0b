// Warm solves of a stream, by the level of the instruction set.
//
// Each iteration solves one frame of a smooth motion from the frame before; the
// counter is what the iterations of the solver took on average.
#include <benchmark/benchmark.h>

#include <string>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "tests/benchmarks/problems.h"

namespace gelenk::benchmarks {
namespace {

constexpr int kFrames = 600;

void SolveStream(benchmark::State& state, const StreamProblem& stream,
                 InstructionSet level) {
  IkProblem problem = *IkProblem::Create(stream.skeleton, stream.goals);
  LevenbergMarquardtSolver solver(level);
  SolverOptions options;
  options.position_tolerance_m = 1e-3;
  options.rotation_tolerance_rad = 1e-2;
  options.detail = ReportDetail::kBrief;
  Eigen::VectorXd positions = stream.start;
  SolveReport report;
  int64_t iterations = 0;
  int64_t missed = 0;
  size_t frame = 0;
  // Back and forth, so that no step is larger than a frame's.
  const size_t period = 2 * (stream.frames.size() - 1);
  for (auto _ : state) {
    frame = (frame + 1) % period;
    const size_t at = frame < stream.frames.size() ? frame : period - frame;
    for (size_t g = 0; g < stream.goals.size(); ++g) {
      problem.SetTarget(static_cast<int>(g), stream.frames[at][g]);
    }
    solver.Solve(problem, options, SolveStart::kWarm, positions, report);
    iterations += report.iteration_count;
    missed += report.outcome != SolveOutcome::kConverged;
  }
  state.counters["iterations"] = benchmark::Counter(
      static_cast<double>(iterations), benchmark::Counter::kAvgIterations);
  state.counters["missed"] = static_cast<double>(missed);
}

void MeasureForwardKinematics(benchmark::State& state,
                              const StreamProblem& stream) {
  WorldTransforms frames;
  for (auto _ : state) {
    ForwardKinematics(*stream.skeleton, stream.start, frames);
    benchmark::DoNotOptimize(frames.data());
  }
}

int Register() {
  static const auto& body = *new StreamProblem(BodyProblem(kFrames));
  static const auto& panda = *new StreamProblem(PandaProblem(kFrames));
  for (InstructionSet level : SupportedInstructionSets()) {
    const std::string name(InstructionSetName(level));
    benchmark::RegisterBenchmark(
        ("warm_body_31_joints_6_goals/" + name).c_str(),
        [level](benchmark::State& state) { SolveStream(state, body, level); });
    benchmark::RegisterBenchmark(
        ("warm_arm_7_joints_1_pose/" + name).c_str(),
        [level](benchmark::State& state) { SolveStream(state, panda, level); });
  }
  benchmark::RegisterBenchmark(
      "forward_kinematics_31_joints",
      [](benchmark::State& state) { MeasureForwardKinematics(state, body); });
  benchmark::RegisterBenchmark(
      "forward_kinematics_7_joints",
      [](benchmark::State& state) { MeasureForwardKinematics(state, panda); });
  return 0;
}

[[maybe_unused]] const int kRegistered = Register();

}  // namespace
}  // namespace gelenk::benchmarks
