// Inverse kinematics of three arms beside the solvers of Orocos KDL, on the
// same targets in the same run: a table with ratios, and a chart.
//
//   ik_peers_benchmark [--targets N] [--chart FILE.svg]
//
// Ours and the peers take turns, set by set; the median of three passes counts.
// "Solved" is what independent forward kinematics confirms, inside the limits.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/bench/ik_run.h"
#include "client/cli/file_bytes.h"
#include "client/cli/text/format.h"
#include "client/cli/text/table.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "tests/benchmarks/ik/arm_sets.h"
#include "tests/benchmarks/ik/kdl_peer.h"
#include "tests/benchmarks/ik/peers_chart.h"

namespace gelenk::benchmarks {
namespace {

using cli::Fixed;
using cli::IkFigures;
using cli::IkSet;
using cli::Significant;
using cli::SolveProblem;

constexpr double kTolerance = 1e-5;
constexpr int kPasses = 3;

SolveProblem Ours(const IkSet& set, SolveStart start) {
  SolverOptions options;
  options.position_tolerance_m = kTolerance;
  options.rotation_tolerance_rad = kTolerance;
  options.detail = ReportDetail::kBrief;
  auto problem =
      std::make_shared<IkProblem>(*IkProblem::Create(set.skeleton, set.goals));
  auto solver = std::make_shared<LevenbergMarquardtSolver>();
  auto report = std::make_shared<SolveReport>();
  return [=, &set](int index, Eigen::Ref<Eigen::VectorXd> positions) {
    problem->SetTarget(0, set.target(index, 0));
    solver->Solve(*problem, options, start, positions, *report);
  };
}

IkFigures Measure(const IkSet& set, const SolveProblem& solve) {
  return JudgeIkAnswers(set, RunIkSet(set, solve, kPasses), kTolerance);
}

void AddRow(const PeerFigures& row, const IkFigures& ours, cli::Table& table) {
  const IkFigures& figures = row.figures;
  table.AddRow(
      {row.arm, row.start, row.solver, Fixed(figures.solved_percent(), 2),
       Significant(figures.mean_us, 3), Significant(figures.median_us, 3),
       Significant(figures.p99_us, 3),
       row.start == "warm" ? Fixed(figures.jumps_percent(), 2) : "",
       Fixed(figures.mean_us / ours.mean_us, 1)});
}

void Compare(const std::string& arm, const std::string& start, const IkSet& set,
             cli::Table& table, std::vector<PeerFigures>& rows) {
  const SolveStart how =
      start == "warm" ? SolveStart::kWarm : SolveStart::kCold;
  const IkFigures ours = Measure(set, Ours(set, how));
  const size_t first = rows.size();
  rows.push_back({arm, start, "gelenk", ours});
  rows.push_back({arm, start, "KDL Newton, limits",
                  Measure(set, KdlNewtonWithLimits(set, kTolerance))});
  rows.push_back({arm, start, "KDL LMA, no limits",
                  Measure(set, KdlLevenbergMarquardt(set, kTolerance))});
  for (size_t i = first; i < rows.size(); ++i) AddRow(rows[i], ours, table);
}

int Main(int target_count, const std::string& chart_path) {
  using cli::Align;
  std::vector<PeerFigures> rows;
  cli::Table table({{"arm"},
                    {"start"},
                    {"solver"},
                    {"solved %", Align::kRight},
                    {"mean µs", Align::kRight},
                    {"median", Align::kRight},
                    {"p99", Align::kRight},
                    {"jumps %", Align::kRight},
                    {"ratio", Align::kRight}});
  for (const ArmSet& set : ArmSets(target_count)) {
    Compare(set.name, "cold", set.cold, table, rows);
    Compare(set.name, "warm", set.warm, table, rows);
  }
  std::printf("%d targets an arm, full pose, %g m and rad, %s\n%s",
              target_count, kTolerance,
              std::string(InstructionSetName(BestInstructionSet())).c_str(),
              table.ToString().c_str());
  if (chart_path.empty()) return 0;
  return cli::WriteFile(chart_path, PeersChart(rows)).ok() ? 0 : 1;
}

}  // namespace
}  // namespace gelenk::benchmarks

int main(int argc, char** argv) {
  CLI::App app("Inverse kinematics beside Orocos KDL");
  int targets = 10000;
  std::string chart;
  app.add_option("--targets", targets, "Targets an arm")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--chart", chart, "Draw the mean times, SVG");
  CLI11_PARSE(app, argc, argv);
  return gelenk::benchmarks::Main(targets, chart);
}
