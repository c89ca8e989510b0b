// What a solve gives, when it is heavy, and when its answer must bring a
// continuation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/session/session.h"
#include "tests/testing/example_sessions.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmGoals;
using ::gelenk::testing::ArmSession;
using ::gelenk::testing::kAim;
using ::gelenk::testing::ReachFrame;
using ::gelenk::testing::WholeFrame;
using ::testing::SizeIs;

constexpr DriverId kDriver = 7;
const absl::Time kNow = absl::FromUnixSeconds(1000);

class SessionSolveTest : public ::testing::Test {
 protected:
  SessionSolveTest() : session_(ArmSession(kNow)) { Claim(); }

  void Claim() { ASSERT_TRUE(session_->Claim(kDriver, false, kNow).ok()); }

  SolvedFrame Solve(bool whole = true) {
    SolvedFrame solved;
    EXPECT_TRUE(session_->Solve(kDriver, solver_, whole, solved).ok());
    return solved;
  }
  SolvedFrame Solve(InputFrame frame) {
    EXPECT_TRUE(session_->Apply(kDriver, frame, kNow).ok());
    return Solve();
  }

  IkSolver solver_;
  std::shared_ptr<Session> session_;
};

TEST_F(SessionSolveTest, KeepsThePose) {
  const SolvedFrame solved = Solve(WholeFrame(1, 0.8, 0.5));
  Eigen::VectorXd positions;
  session_->CopyPositions(positions);
  EXPECT_EQ(positions, solved.positions);
  EXPECT_GT(solved.solve_duration, absl::ZeroDuration());
}

TEST_F(SessionSolveTest, GivesTheWholeReportWhenAsked) {
  EXPECT_EQ(Solve(true).detail, ReportDetail::kWhole);
  EXPECT_EQ(Solve(false).detail, ReportDetail::kBrief);
  EXPECT_THAT(Solve(false).report.position_errors_m, SizeIs(3));
}

TEST_F(SessionSolveTest, AnswersBitByBitTheSame) {
  const auto other = ArmSession(kNow);
  ASSERT_TRUE(other->Claim(kDriver, false, kNow).ok());
  for (int i = 1; i <= 20; ++i) {
    const SolvedFrame here = Solve(WholeFrame(i, 1.0 - 0.03 * i, 0.02 * i));
    InputFrame frame = WholeFrame(i, 1.0 - 0.03 * i, 0.02 * i);
    ASSERT_TRUE(other->Apply(kDriver, frame, kNow).ok());
    SolvedFrame there;
    IkSolver fresh;
    ASSERT_TRUE(other->Solve(kDriver, fresh, false, there).ok());
    ASSERT_EQ(here.positions, there.positions) << "frame " << i;
  }
}

TEST_F(SessionSolveTest, IsNotHeavyWhenWarm) {
  EXPECT_FALSE(session_->IsHeavy());
}

TEST_F(SessionSolveTest, IsHeavyUntilSolvedOnce) {
  SessionState cold;
  cold.positions = Eigen::Vector3d::Zero();
  cold.cold = true;
  session_ = ArmSession(kNow, ArmGoals(), cold);
  Claim();
  EXPECT_TRUE(session_->IsHeavy());
  Solve();
  EXPECT_FALSE(session_->IsHeavy());
}

TEST_F(SessionSolveTest, IsHeavyWhenItMayRestartOrDiagnoses) {
  SessionState restarts;
  restarts.options.max_restarts = 1;
  EXPECT_FALSE(ArmSession(kNow, ArmGoals())->IsHeavy());
  restarts.positions = Eigen::Vector3d::Zero();
  restarts.cold = false;
  EXPECT_TRUE(ArmSession(kNow, ArmGoals(), restarts)->IsHeavy());
  SessionState diagnoses = restarts;
  diagnoses.options.max_restarts.reset();
  diagnoses.options.detail = ReportDetail::kDiagnosis;
  EXPECT_TRUE(ArmSession(kNow, ArmGoals(), diagnoses)->IsHeavy());
}

TEST_F(SessionSolveTest, AFrameThatNamesEveryGoalNeedsNoContinuation) {
  EXPECT_FALSE(Solve(WholeFrame(1, 0.8, 0.5)).needs_continuation);
}

TEST_F(SessionSolveTest, AFrameThatLeavesAGoalOutNeedsOne) {
  EXPECT_TRUE(Solve(ReachFrame(1, 0.8, 0.5)).needs_continuation);
  EXPECT_FALSE(Solve(WholeFrame(2, 0.8, 0.5)).needs_continuation)
      << "the driver knows everything again";
}

TEST_F(SessionSolveTest, AChangedWeightNeedsOneForGood) {
  InputFrame frame = WholeFrame(1, 0.8, 0.5);
  frame.updates[kAim].weight = 0.5;
  EXPECT_TRUE(Solve(frame).needs_continuation);
  EXPECT_TRUE(Solve(WholeFrame(2, 0.8, 0.5)).needs_continuation);
}

TEST_F(SessionSolveTest, AMovedActorNeedsOneForGood) {
  InputFrame frame = WholeFrame(1, 0.8, 0.5);
  frame.world_from_skeleton = RigidTransform();
  EXPECT_TRUE(Solve(frame).needs_continuation);
  EXPECT_TRUE(Solve(WholeFrame(2, 0.8, 0.5)).needs_continuation);
}

TEST_F(SessionSolveTest, ChangedGoalsNeedOneForGood) {
  InputFrame frame = WholeFrame(1, 0.8, 0.5);
  frame.patch = [](absl::Span<const Goal> goals) {
    return absl::StatusOr<std::vector<Goal>>(
        std::vector<Goal>(goals.begin(), goals.end()));
  };
  EXPECT_TRUE(Solve(frame).needs_continuation);
  EXPECT_TRUE(Solve(WholeFrame(2, 0.8, 0.5)).needs_continuation);
}

TEST_F(SessionSolveTest, AnUpdateBySomebodyElseNeedsOneForGood) {
  session_->Release(kDriver);
  ASSERT_TRUE(
      session_->Update([](SessionState&) { return absl::OkStatus(); }, {}, kNow)
          .ok());
  Claim();
  EXPECT_TRUE(Solve(WholeFrame(1, 0.8, 0.5)).needs_continuation);
}

TEST_F(SessionSolveTest, GoalsThatCameWithAResumeNeedOneForGood) {
  const std::vector<Goal> goals = ArmGoals();
  Eigen::VectorXd positions = Eigen::Vector3d(0.2, 0.2, 0.2);
  ASSERT_TRUE(session_->Resume(kDriver, {positions, 3, nullptr, nullptr}).ok());
  EXPECT_FALSE(Solve(WholeFrame(4, 0.8, 0.5)).needs_continuation);
  ASSERT_TRUE(session_->Resume(kDriver, {positions, 4, &goals, nullptr}).ok());
  EXPECT_TRUE(Solve(WholeFrame(5, 0.8, 0.5)).needs_continuation);
}

TEST_F(SessionSolveTest, WithoutGoalsThePoseStays) {
  session_ = ArmSession(kNow, {});
  Claim();
  InputFrame frame;
  frame.sequence_number = 1;
  const SolvedFrame solved = Solve(frame);
  EXPECT_EQ(solved.positions, Eigen::VectorXd(Eigen::Vector3d(0.1, 0.2, 0.3)));
  EXPECT_EQ(solved.report.outcome, SolveOutcome::kConverged);
  EXPECT_FALSE(solved.needs_continuation);
}

// --- What viewers see ---

TEST_F(SessionSolveTest, ViewersGetEachPoseOnce) {
  uint64_t version = ~uint64_t{0};
  Eigen::VectorXd positions;
  RigidTransform place;
  int64_t number = 0;
  EXPECT_TRUE(session_->CopyIfNewer(version, positions, place, number));
  EXPECT_FALSE(session_->CopyIfNewer(version, positions, place, number));
  const SolvedFrame solved = Solve(WholeFrame(41, 0.8, 0.5));
  EXPECT_TRUE(session_->CopyIfNewer(version, positions, place, number));
  EXPECT_EQ(positions, solved.positions);
  EXPECT_EQ(number, 41);
  EXPECT_FALSE(session_->CopyIfNewer(version, positions, place, number));
}

TEST_F(SessionSolveTest, ViewersCountSolvesWithoutNumbers) {
  session_->Release(kDriver);
  SolvedFrame solved;
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(session_->Solve(kUnaryDriver, solver_, true, solved).ok());
  }
  uint64_t version = 0;
  Eigen::VectorXd positions;
  RigidTransform place;
  int64_t number = 0;
  EXPECT_TRUE(session_->CopyIfNewer(version, positions, place, number));
  EXPECT_EQ(number, 3);
}

}  // namespace
}  // namespace gelenk::server
