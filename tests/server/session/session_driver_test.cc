// Who may drive a session. What a driver tells it is in session_apply_test.cc.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/session/session.h"
#include "tests/testing/example_sessions.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmSession;
using ::gelenk::testing::ReachFrame;
using ::gelenk::testing::StateOf;
using ::testing::HasSubstr;

constexpr DriverId kFirst = 1;
constexpr DriverId kSecond = 2;
const absl::Time kNow = absl::FromUnixSeconds(1000);

absl::StatusCode ApplyAs(Session& session, DriverId driver) {
  InputFrame frame = ReachFrame(session.sequence_number() + 1, 0.7, 0.7);
  return session.Apply(driver, frame, kNow).code();
}

absl::StatusCode SolveAs(Session& session, DriverId driver) {
  IkSolver solver;
  SolvedFrame solved;
  return session.Solve(driver, solver, true, solved).code();
}

TEST(SessionDriverTest, WithoutDriverTakesUnaryCalls) {
  const auto session = ArmSession(kNow);
  EXPECT_EQ(ApplyAs(*session, kUnaryDriver), absl::StatusCode::kOk);
  EXPECT_EQ(SolveAs(*session, kUnaryDriver), absl::StatusCode::kOk);
}

TEST(SessionDriverTest, WithoutDriverRefusesWhoHasNotClaimedIt) {
  const auto session = ArmSession(kNow);
  EXPECT_EQ(ApplyAs(*session, kFirst), absl::StatusCode::kAborted);
}

TEST(SessionDriverTest, ObeysItsDriverAndNobodyElse) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  EXPECT_TRUE(session->CheckDriver(kFirst).ok());
  EXPECT_EQ(ApplyAs(*session, kFirst), absl::StatusCode::kOk);
  EXPECT_EQ(SolveAs(*session, kFirst), absl::StatusCode::kOk);
  EXPECT_EQ(ApplyAs(*session, kSecond), absl::StatusCode::kAborted);
  EXPECT_EQ(SolveAs(*session, kSecond), absl::StatusCode::kAborted);
}

TEST(SessionDriverTest, RefusesUnaryCallsWhileDriven) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  EXPECT_EQ(ApplyAs(*session, kUnaryDriver),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(SolveAs(*session, kUnaryDriver),
            absl::StatusCode::kFailedPrecondition);
}

TEST(SessionDriverTest, HasOneDriverAtATime) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  const absl::Status second = session->Claim(kSecond, false, kNow);
  EXPECT_EQ(second.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(second.message()),
              HasSubstr("sessions/arm has a driver"));
  EXPECT_TRUE(session->CheckDriver(kFirst).ok());
}

TEST(SessionDriverTest, MayBeClaimedAgainByItsDriver) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  EXPECT_TRUE(session->Claim(kFirst, false, kNow).ok());
}

TEST(SessionDriverTest, TellsWhoLostIt) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  ASSERT_TRUE(session->Claim(kSecond, true, kNow).ok());
  EXPECT_EQ(session->CheckDriver(kFirst).code(), absl::StatusCode::kAborted);
  EXPECT_EQ(ApplyAs(*session, kFirst), absl::StatusCode::kAborted);
  EXPECT_EQ(SolveAs(*session, kFirst), absl::StatusCode::kAborted);
  EXPECT_EQ(ApplyAs(*session, kSecond), absl::StatusCode::kOk);
}

TEST(SessionDriverTest, WhoLostItChangesNothing) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  ASSERT_TRUE(session->Claim(kSecond, true, kNow).ok());
  const std::string before = StateOf(*session);
  ApplyAs(*session, kFirst);
  SolveAs(*session, kFirst);
  const Eigen::VectorXd elsewhere = Eigen::Vector3d(1, 1, 1);
  EXPECT_FALSE(session->Resume(kFirst, {elsewhere, 9, nullptr, nullptr}).ok());
  EXPECT_EQ(StateOf(*session), before);
}

TEST(SessionDriverTest, IsNotReleasedByWhoLostIt) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  ASSERT_TRUE(session->Claim(kSecond, true, kNow).ok());
  session->Release(kFirst);
  EXPECT_TRUE(session->CheckDriver(kSecond).ok());
}

TEST(SessionDriverTest, IsFreeAfterRelease) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  session->Release(kFirst);
  EXPECT_EQ(ApplyAs(*session, kUnaryDriver), absl::StatusCode::kOk);
  EXPECT_TRUE(session->Claim(kSecond, false, kNow).ok());
}

TEST(SessionDriverTest, TellsEverybodyThatItHasEnded) {
  const auto session = ArmSession(kNow);
  ASSERT_TRUE(session->Claim(kFirst, false, kNow).ok());
  EXPECT_TRUE(session->ended().ok());
  session->End(absl::NotFoundError("deleted"));
  session->End(absl::NotFoundError("a later reason does not count"));
  const absl::Status deleted = absl::NotFoundError("deleted");
  EXPECT_EQ(session->ended(), deleted);
  EXPECT_EQ(session->CheckDriver(kFirst), deleted);
  EXPECT_EQ(session->Claim(kSecond, true, kNow), deleted);
  EXPECT_EQ(SolveAs(*session, kFirst), absl::StatusCode::kNotFound);
  EXPECT_EQ(ApplyAs(*session, kUnaryDriver), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace gelenk::server
