// Times a solver on a set of problems and checks its answers by forward
// kinematics of their own.
#ifndef CLIENT_CLI_BENCH_IK_RUN_H_
#define CLIENT_CLI_BENCH_IK_RUN_H_

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "client/cli/bench/ik_set.h"

namespace gelenk::cli {

// An answer is off by at most the tolerance along each axis.
inline constexpr double kAxisSlack = 1.7320508075688772;
// A joint that moved further than this from a warm start has jumped, rad or m.
inline constexpr double kJump = 0.5;
// An answer on a limit may be this far outside, rad or m.
inline constexpr double kLimitSlack = 1e-6;

// Solves one problem: `positions` is the start, then the answer. What the
// solver itself claims does not count.
using SolveProblem =
    std::function<void(int problem, Eigen::Ref<Eigen::VectorXd> positions)>;

struct IkAnswers {
  // A column a problem.
  Eigen::MatrixXd positions;
  // A problem, microseconds.
  std::vector<double> durations_us;
};

// Each problem is solved `passes` times, and the median of its times counts, so
// that an interruption by other programs is not taken for the solver's time.
// The first problems are solved once before, to warm up. `progress` gets the
// count of problems done.
IkAnswers RunIkSet(const IkSet& set, const SolveProblem& solve, int passes,
                   const std::function<void(int)>& progress = nullptr);

// Solves all problems in one call: a column a problem, starts in, answers out.
using SolveBatch = std::function<void(Eigen::Ref<Eigen::MatrixXd> positions)>;

// One call to warm up, then `passes` of them; every problem gets the same share
// of the fastest: a call is long enough to be interrupted each time.
IkAnswers RunIkBatch(const Eigen::MatrixXd& starts, const SolveBatch& solve,
                     int passes);

struct IkFigures {
  int count = 0;
  // Within tolerance (kAxisSlack) and limits.
  int solved = 0;
  // Of the solved ones.
  int jumped = 0;
  int outside_limits = 0;
  double mean_us = 0;
  double median_us = 0;
  double p99_us = 0;

  double solved_percent() const { return Share(solved, count); }
  double jumps_percent() const { return Share(jumped, solved); }

 private:
  static double Share(int part, int whole) {
    return whole == 0 ? 0 : 100.0 * part / whole;
  }
};

// `tolerance` is in m and rad.
IkFigures JudgeIkAnswers(const IkSet& set, const IkAnswers& answers,
                         double tolerance);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_BENCH_IK_RUN_H_
