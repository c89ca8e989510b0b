// gelenk bench: what solves cost on anyone's skeleton and targets.
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/bench/ik_run.h"
#include "client/cli/bench/ik_set.h"
#include "client/cli/bench/number_table.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/progress_bar.h"
#include "client/cli/skeleton_file.h"
#include "client/cli/text/table.h"
#include "gelenk/ik/batch_solver.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"

namespace gelenk::cli {
namespace {

struct BenchOptions {
  std::string skeleton_path;
  std::optional<double> unit_m;
  std::vector<std::string> tips;
  std::string targets_path;
  BenchStart start = BenchStart::kCold;
  BenchGoal goal = BenchGoal::kPose;
  double tolerance = 1e-5;
  std::optional<int> restarts;
  InstructionSet level = BestInstructionSet();
  int passes = 3;
  bool batch = false;
  std::string out_path;
  Format format = Format::kTable;
};

SolverOptions SolverOptionsFor(const BenchOptions& options) {
  SolverOptions solver;
  solver.position_tolerance_m = options.tolerance;
  solver.rotation_tolerance_rad = options.tolerance;
  solver.max_restarts = options.restarts;
  solver.detail = ReportDetail::kBrief;
  return solver;
}

SolveStart StartOf(const BenchOptions& options) {
  return options.start == BenchStart::kWarm ? SolveStart::kWarm
                                            : SolveStart::kCold;
}

GoalTarget TargetFor(const IkSet& set, int problem, int goal) {
  const RigidTransform& target = set.target(problem, goal);
  return set.goal == BenchGoal::kPose ? GoalTarget(target)
                                      : GoalTarget(target.translation);
}

// All targets in one call, `passes` times.
IkAnswers SolveAtOnce(const BenchOptions& options,
                      const SolverOptions& solver_options, const IkSet& set,
                      IkProblem& problem) {
  std::vector<GoalTarget> targets;
  Eigen::MatrixXd starts(set.skeleton->position_count(), set.size());
  for (int i = 0; i < set.size(); ++i) {
    starts.col(i) = set.start(i);
    for (int g = 0; g < static_cast<int>(set.goals.size()); ++g) {
      targets.push_back(TargetFor(set, i, g));
    }
  }
  BatchSolver solver(options.level);
  BatchReport report;
  return RunIkBatch(
      starts,
      [&](Eigen::Ref<Eigen::MatrixXd> positions) {
        solver.Solve(problem, targets, solver_options, StartOf(options),
                     positions, report);
      },
      options.passes);
}

absl::StatusOr<IkAnswers> Solve(const BenchOptions& options, const IkSet& set) {
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(set.skeleton, set.goals);
  if (!problem.ok()) return problem.status();
  const SolverOptions solver_options = SolverOptionsFor(options);
  if (absl::Status status = CheckSolverOptions(solver_options); !status.ok()) {
    return status;
  }
  if (options.batch) {
    return SolveAtOnce(options, solver_options, set, *problem);
  }
  LevenbergMarquardtSolver solver(options.level);
  SolveReport report;
  const auto solve = [&](int index, Eigen::Ref<Eigen::VectorXd> positions) {
    for (int g = 0; g < static_cast<int>(set.goals.size()); ++g) {
      problem->SetTarget(g, TargetFor(set, index, g));
    }
    solver.Solve(*problem, solver_options, StartOf(options), positions, report);
  };
  ProgressBar progress("solving", int64_t{options.passes} * set.size());
  return RunIkSet(set, solve, options.passes,
                  [&progress](int done) { progress.Update(done); });
}

std::string AnswersCsv(const IkSet& set, const IkAnswers& answers) {
  std::string csv =
      absl::StrCat(absl::StrJoin(set.coordinate_names, ","), "\n");
  for (int i = 0; i < set.size(); ++i) {
    for (size_t k = 0; k < set.coordinates.size(); ++k) {
      absl::StrAppendFormat(&csv, "%s%.17g", k == 0 ? "" : ",",
                            answers.positions(set.coordinates[k], i));
    }
    csv += '\n';
  }
  return csv;
}

Json FiguresJson(const BenchOptions& options, const IkFigures& figures) {
  Json json;
  json["solved_percent"] = figures.solved_percent();
  json["mean_us"] = figures.mean_us;
  json["median_us"] = figures.median_us;
  json["p99_us"] = figures.p99_us;
  json["jumps_percent"] = figures.jumps_percent();
  json["targets"] = figures.count;
  json["solved"] = figures.solved;
  json["jumps"] = figures.jumped;
  json["outside_limits"] = figures.outside_limits;
  json["start"] = options.start == BenchStart::kWarm ? "warm" : "cold";
  json["tolerance"] = options.tolerance;
  json["batch"] = options.batch;
  json["instruction_set"] = std::string(InstructionSetName(options.level));
  return json;
}

std::string FiguresText(const BenchOptions& options, const IkFigures& figures) {
  Facts facts;
  facts.Add("skeleton", BaseName(options.skeleton_path));
  facts.Add("targets",
            absl::StrCat(figures.count, ", from a ",
                         options.start == BenchStart::kWarm ? "warm" : "cold",
                         " start, ", Significant(options.tolerance, 3),
                         " m and rad"));
  facts.Add("solved", absl::StrCat(Percent(figures.solved, figures.count), " (",
                                   figures.solved, "), by forward kinematics"));
  if (options.batch) {
    facts.Add("a target", absl::StrCat(Significant(figures.mean_us, 3),
                                       " µs, of one call for all"));
  } else {
    facts.Add("mean", absl::StrCat(Significant(figures.mean_us, 3), " µs"));
    facts.Add("median", absl::StrCat(Significant(figures.median_us, 3), " µs"));
    facts.Add("p99", absl::StrCat(Significant(figures.p99_us, 3), " µs"));
  }
  if (options.start == BenchStart::kWarm) {
    facts.Add("jumps",
              absl::StrCat(Percent(figures.jumped, figures.solved), " (",
                           figures.jumped, ") went further than 0.5 rad"));
  }
  facts.Add("instructions", InstructionSetName(options.level));
  return facts.ToString();
}

absl::Status RunBenchIk(const BenchOptions& options, std::string* output) {
  const absl::StatusOr<SkeletonFile> file =
      ReadSkeletonFile(options.skeleton_path, options.unit_m);
  if (!file.ok()) return file.status();
  const absl::StatusOr<NumberTable> table =
      ReadNumberTable(options.targets_path);
  if (!table.ok()) return table.status();
  const absl::StatusOr<IkSet> set = MakeIkSet(
      file->skeleton, options.tips, *table, options.start, options.goal);
  if (!set.ok()) return InFile(options.targets_path, set.status());
  const absl::StatusOr<IkAnswers> answers = Solve(options, *set);
  if (!answers.ok()) return answers.status();

  const IkFigures figures = JudgeIkAnswers(*set, *answers, options.tolerance);
  *output += options.format == Format::kJson
                 ? JsonText(FiguresJson(options, figures))
                 : FiguresText(options, figures);
  if (options.out_path.empty()) return absl::OkStatus();
  return WriteFile(options.out_path, AnswersCsv(*set, *answers));
}

std::map<std::string, InstructionSet> Levels() {
  std::map<std::string, InstructionSet> levels;
  for (InstructionSet level : SupportedInstructionSets()) {
    levels.emplace(InstructionSetName(level), level);
  }
  return levels;
}

void AddProblemOptions(CLI::App& ik, BenchOptions* options) {
  ik.add_option("--skeleton", options->skeleton_path,
                "A skeleton file: .json, .urdf, .bvh, .gltf, .glb")
      ->required()
      ->option_text("FILE");
  ik.add_option("--tip", options->tips,
                "End effector or joint with a target; repeatable")
      ->required()
      ->allow_extra_args(false)
      ->option_text("ID");
  ik.add_option(
        "--targets", options->targets_path,
        "Columns q0, q1, ... (movable joints from the root to the tips, "
        "or all), or px,py,pz,qx,qy,qz,qw (of a second tip px1, ...), "
        "which count where both are there; and warm0, warm1, ... for "
        "--start warm")
      ->required()
      ->option_text("FILE.csv[.gz]");
  AddChoice<BenchStart>(
      ik, "--start", &options->start,
      {{"cold", BenchStart::kCold}, {"warm", BenchStart::kWarm}},
      "The middle of each joint's range, with restarts "
      "(default), or the columns warm0, ...");
  AddChoice<BenchGoal>(
      ik, "--goal", &options->goal,
      {{"pose", BenchGoal::kPose}, {"position", BenchGoal::kPosition}},
      "What of the target counts (default pose)");
  ik.add_option("--tolerance", options->tolerance,
                "Errors that count as reached, m and rad; default 1e-5")
      ->check(Positive())
      ->option_text("T");
  ik.add_option("--unit", options->unit_m,
                "Metres per unit of a BVH file; default: guessed")
      ->check(Positive())
      ->option_text("M");
}

}  // namespace

Command AddBenchCommand(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* bench =
      app.add_subcommand("bench", "Measure the solver on your own problems");
  bench->require_subcommand(1);
  CLI::App* ik = bench->add_subcommand(
      "ik",
      "Inverse kinematics, target by target, in this process, on one thread; "
      "every answer is checked by forward kinematics");
  AddProblemOptions(*ik, options.get());
  ik->add_option("--restarts", options->restarts,
                 "Starts to try beyond the first; default 40 cold, 0 warm")
      ->check(CLI::Range(0, kMaxRestarts).description(""))
      ->option_text("N");
  AddChoice<InstructionSet>(*ik, "--isa", &options->level, Levels(),
                            "Level of the instruction set; default: the best "
                            "that this processor has");
  ik->add_option("--passes", options->passes,
                 "Times that each target is solved; the median counts "
                 "(default 3)")
      ->check(CLI::Range(1, 1000).description(""))
      ->option_text("N");
  ik->add_flag("--batch", options->batch,
               "Solve all targets in one call, and divide its time");
  ik->add_option("--out", options->out_path,
                 "Write the answers: a row a target, joints as columns")
      ->option_text("FILE.csv");
  AddFormatOption(*ik, &options->format);
  ik->footer(
      "Example:\n"
      "  gelenk bench ik --skeleton arm.urdf --tip tool0 --targets poses.csv "
      "--start cold");
  return {bench, [options](const GlobalOptions&, std::string* output) {
            return RunBenchIk(*options, output);
          }};
}

}  // namespace gelenk::cli
