#include "gelenk/ik/solver_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "absl/strings/str_cat.h"
#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> Lines(const SolverOptions& options) {
  return ViolationLines(CheckSolverOptions(options));
}

TEST(SolverOptionsTest, DefaultsAreFine) {
  EXPECT_THAT(Lines(SolverOptions()), IsEmpty());
}

TEST(SolverOptionsTest, CountsFromBothSides) {
  SolverOptions options;
  options.max_iterations = 0;
  options.max_restarts = kMaxRestarts;
  EXPECT_THAT(Lines(options), IsEmpty());
  options.max_iterations = kMaxIterations;
  options.max_restarts = 0;
  EXPECT_THAT(Lines(options), IsEmpty());
  options.max_iterations = -1;
  options.max_restarts = -1;
  EXPECT_THAT(Lines(options),
              ElementsAre(absl::StrCat("max_iterations: want 0 to ",
                                       kMaxIterations, ", got -1"),
                          absl::StrCat("max_restarts: want 0 to ", kMaxRestarts,
                                       ", got -1")));
  options.max_iterations = kMaxIterations + 1;
  options.max_restarts = kMaxRestarts + 1;
  EXPECT_EQ(Lines(options).size(), 2u);
}

TEST(SolverOptionsTest, AllAttemptsTogetherAreBounded) {
  SolverOptions options;
  options.max_iterations = 1000;
  options.max_restarts = kMaxTotalIterations / 1000 - 1;
  EXPECT_THAT(Lines(options), IsEmpty());
  ++*options.max_restarts;
  EXPECT_THAT(
      Lines(options),
      ElementsAre(absl::StrCat(
          "max_restarts: want at most ", kMaxTotalIterations,
          " iterations over all restarts, got ", kMaxTotalIterations + 1000)));
}

TEST(SolverOptionsTest, TolerancesArePositive) {
  for (double bad : {0.0, -1e-3, double{NAN}, double{INFINITY}}) {
    SolverOptions options;
    options.position_tolerance_m = bad;
    options.rotation_tolerance_rad = bad;
    EXPECT_THAT(
        Lines(options),
        ElementsAre(
            absl::StrCat("position_tolerance_m: want a finite number > 0, got ",
                         bad),
            absl::StrCat(
                "rotation_tolerance_rad: want a finite number > 0, got ",
                bad)));
  }
}

TEST(SolverOptionsTest, TimeLimitsArePositive) {
  SolverOptions options;
  options.time_limit = absl::Nanoseconds(1);
  EXPECT_THAT(Lines(options), IsEmpty());
  options.time_limit = absl::ZeroDuration();
  EXPECT_THAT(Lines(options),
              ElementsAre("time_limit: want more than 0, got 0"));
  options.time_limit = absl::Milliseconds(-3);
  EXPECT_THAT(Lines(options),
              ElementsAre("time_limit: want more than 0, got -3ms"));
}

TEST(SolverOptionsTest, OnlyColdStartsRestartUnlessTold) {
  SolverOptions options;
  EXPECT_EQ(RestartBudget(options, SolveStart::kWarm), 0);
  EXPECT_EQ(RestartBudget(options, SolveStart::kCold), kColdRestarts);
  options.max_restarts = 3;
  EXPECT_EQ(RestartBudget(options, SolveStart::kWarm), 3);
  EXPECT_EQ(RestartBudget(options, SolveStart::kCold), 3);
}

}  // namespace
}  // namespace gelenk
