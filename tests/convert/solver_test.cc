#include "convert/solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/testing/violation_lines.h"

namespace gelenk::convert {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(ConvertSolverTest, OptionsComeRound) {
  v1::SolverOptions proto;
  proto.set_method(v1::SOLVER_METHOD_LEVENBERG_MARQUARDT);
  proto.set_max_iterations(7);
  proto.set_max_restarts(3);
  proto.set_restart_seed(-12345678901);
  proto.set_position_tolerance_m(1e-5);
  proto.set_rotation_tolerance_rad(2e-3);
  proto.mutable_time_limit()->set_seconds(2);
  proto.mutable_time_limit()->set_nanos(5000);
  proto.set_diagnose(true);
  const auto options = FromProto(proto);
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->method, SolverMethod::kLevenbergMarquardt);
  EXPECT_EQ(options->time_limit, absl::Seconds(2) + absl::Microseconds(5));
  EXPECT_EQ(options->max_iterations, 7);
  EXPECT_EQ(options->max_restarts, 3);
  EXPECT_EQ(options->restart_seed, -12345678901);
  EXPECT_EQ(options->position_tolerance_m, 1e-5);
  EXPECT_EQ(options->rotation_tolerance_rad, 2e-3);
  EXPECT_EQ(options->detail, ReportDetail::kDiagnosis);
  v1::SolverOptions again;
  ToProto(*options, &again);
  EXPECT_EQ(again.DebugString(), proto.DebugString());
}

TEST(ConvertSolverTest, UnsetOptionsAreDefaults) {
  const auto options = FromProto(v1::SolverOptions());
  ASSERT_TRUE(options.ok());
  EXPECT_EQ(options->max_iterations, SolverOptions().max_iterations);
  EXPECT_EQ(options->method, SolverMethod::kAuto);
  EXPECT_EQ(options->time_limit, std::nullopt);
  EXPECT_EQ(options->max_restarts, std::nullopt);
  EXPECT_EQ(options->position_tolerance_m,
            SolverOptions().position_tolerance_m);
  EXPECT_EQ(options->detail, ReportDetail::kWhole);
  v1::SolverOptions again;
  ToProto(*options, &again);
  EXPECT_FALSE(again.has_max_restarts()) << "it depends on the start";
}

TEST(ConvertSolverTest, EveryMethodComesRound) {
  for (int number = v1::SolverMethod_MIN; number <= v1::SolverMethod_MAX;
       ++number) {
    v1::SolverOptions proto;
    proto.set_method(static_cast<v1::SolverMethod>(number));
    const auto options = FromProto(proto);
    ASSERT_TRUE(options.ok()) << options.status();
    v1::SolverOptions again;
    ToProto(*options, &again);
    EXPECT_EQ(again.method(), number);
  }
}

TEST(ConvertSolverTest, ZeroRestartsAreNotUnset) {
  v1::SolverOptions proto;
  proto.set_max_restarts(0);
  EXPECT_EQ(FromProto(proto)->max_restarts, 0);
}

TEST(ConvertSolverTest, NamesEveryOptionOutOfRange) {
  v1::SolverOptions proto;
  proto.set_method(static_cast<v1::SolverMethod>(99));
  proto.set_max_iterations(-1);
  proto.set_position_tolerance_m(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(ViolationLines(FromProto(proto).status()),
              ElementsAre("method: no such solver method: 99",
                          HasSubstr("max_iterations: "),
                          HasSubstr("position_tolerance_m: ")));
}

class ConvertReportTest : public ::testing::Test {
 protected:
  ConvertReportTest() {
    report_.outcome = SolveOutcome::kStalledAtLimits;
    report_.method = SolverMethod::kMinimalChange;
    report_.kkt_residual = 0.75;
    report_.iteration_count = 12;
    report_.restart_count = 3;
    report_.position_errors_m = {0.5, 0};
    report_.rotation_errors_rad = {0, 0.25};
    report_.limited_joints = {4, 7};
    report_.change = 1.5;
    report_.rank = 5;
    report_.free_velocity_count = 2;
    report_.translation_manipulability = 0.125;
    report_.rotation_manipulability = 2;
  }

  v1::SolveReport Told(ReportDetail detail) const {
    v1::SolveReport proto;
    proto.add_limited_joints(99);
    ToProto(report_, detail, absl::Milliseconds(1500), &proto);
    return proto;
  }

  SolveReport report_;
};

TEST_F(ConvertReportTest, BriefOnesSayOutcomeAndErrors) {
  const v1::SolveReport proto = Told(ReportDetail::kBrief);
  EXPECT_EQ(proto.outcome(), v1::SolveReport::OUTCOME_STALLED_AT_LIMITS);
  EXPECT_EQ(proto.iteration_count(), 12);
  EXPECT_EQ(proto.restart_count(), 3);
  EXPECT_THAT(proto.position_errors_m(), ElementsAre(0.5, 0));
  EXPECT_THAT(proto.rotation_errors_rad(), ElementsAre(0, 0.25));
  EXPECT_EQ(proto.solve_duration().seconds(), 1);
  EXPECT_EQ(proto.solve_duration().nanos(), 500000000);
  EXPECT_THAT(proto.limited_joints(), IsEmpty());
  EXPECT_EQ(proto.change(), 0);
  EXPECT_EQ(proto.rank(), 0);
}

TEST_F(ConvertReportTest, WholeOnesSayWhatMoved) {
  const v1::SolveReport proto = Told(ReportDetail::kWhole);
  EXPECT_EQ(proto.method(), v1::SOLVER_METHOD_MINIMAL_CHANGE);
  EXPECT_EQ(proto.kkt_residual(), 0.75);
  EXPECT_THAT(proto.limited_joints(), ElementsAre(4, 7));
  EXPECT_EQ(proto.change(), 1.5);
  EXPECT_EQ(proto.rank(), 0);
}

TEST_F(ConvertReportTest, DiagnosesSayEverything) {
  const v1::SolveReport proto = Told(ReportDetail::kDiagnosis);
  EXPECT_THAT(proto.limited_joints(), ElementsAre(4, 7));
  EXPECT_EQ(proto.rank(), 5);
  EXPECT_EQ(proto.free_velocity_count(), 2);
  EXPECT_EQ(proto.translation_manipulability(), 0.125);
  EXPECT_EQ(proto.rotation_manipulability(), 2);
}

TEST_F(ConvertReportTest, EveryOutcomeHasItsNumber) {
  const auto told = [this](SolveOutcome outcome) {
    report_.outcome = outcome;
    return Told(ReportDetail::kBrief).outcome();
  };
  EXPECT_EQ(told(SolveOutcome::kConverged), v1::SolveReport::OUTCOME_CONVERGED);
  EXPECT_EQ(told(SolveOutcome::kUnreachable),
            v1::SolveReport::OUTCOME_UNREACHABLE);
  EXPECT_EQ(told(SolveOutcome::kStalledAtLimits),
            v1::SolveReport::OUTCOME_STALLED_AT_LIMITS);
  EXPECT_EQ(told(SolveOutcome::kSingular), v1::SolveReport::OUTCOME_SINGULAR);
  EXPECT_EQ(told(SolveOutcome::kTimeLimit),
            v1::SolveReport::OUTCOME_TIME_LIMIT);
  EXPECT_EQ(told(SolveOutcome::kIterationLimit),
            v1::SolveReport::OUTCOME_ITERATION_LIMIT);
}

}  // namespace
}  // namespace gelenk::convert
