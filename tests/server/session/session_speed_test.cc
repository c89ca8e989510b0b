// Sessions that keep their joints' speed limits between frames.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "gelenk/skeleton/skeleton_builder.h"
#include "server/session/session.h"
#include "tests/testing/ik_targets.h"

namespace gelenk::server {
namespace {

constexpr DriverId kDriver = 7;
constexpr double kFastest_m_per_s = 2;
constexpr double kTolerance_m = 1e-9;

// A slider along X, whose target is 10 m away.
class SessionSpeedTest : public ::testing::Test {
 protected:
  SessionSpeedTest() { session_ = Make(true); }

  std::unique_ptr<Session> Make(bool limit_speed) {
    Joint slider;
    slider.id = "slider";
    slider.type = JointType::kPrismatic;
    slider.limits.max_velocity = {kFastest_m_per_s};
    auto trees = std::make_shared<SharedTrees>(
        *SkeletonBuilder().AddJoint(slider).Build());
    SessionState state;
    state.goals = {testing::PositionGoalFor("slider", {10, 0, 0})};
    state.positions = Eigen::VectorXd::Zero(1);
    state.cold = false;
    state.options.limit_speed = limit_speed;
    IkProblem problem = *trees->CreateProblem(state.goals, state.options);
    auto session =
        std::make_unique<Session>("sessions/s", "skeletons/s", "s", trees,
                                  std::move(problem), state, absl::UnixEpoch());
    EXPECT_TRUE(session->Claim(kDriver, false, absl::UnixEpoch()).ok());
    return session;
  }

  // Where the slider is after a frame.
  double Frame(Session& session, std::optional<absl::Duration> capture_time) {
    InputFrame frame;
    frame.sequence_number = ++number_;
    frame.capture_time = capture_time;
    EXPECT_TRUE(session.Apply(kDriver, frame, absl::UnixEpoch()).ok());
    EXPECT_TRUE(session.Solve(kDriver, solver_, true, solved_).ok());
    return solved_.positions[0];
  }

  std::unique_ptr<Session> session_;
  IkSolver solver_;
  SolvedFrame solved_;
  int64_t number_ = 0;
};

TEST_F(SessionSpeedTest, NoFasterThanTheJointCan) {
  session_->Resume(kDriver, {Eigen::VectorXd::Zero(1), 0}).IgnoreError();
  // The first frame has nothing to be measured against.
  const double start = Frame(*session_, absl::Seconds(5));
  EXPECT_NEAR(start, 10, 1e-3);
  ASSERT_TRUE(
      session_->Resume(kDriver, {Eigen::VectorXd::Zero(1), number_}).ok());
  JointMotion motion;
  motion.capture_time = absl::Seconds(5);
  motion.velocity = Eigen::VectorXd::Zero(1);
  ResumeState state{Eigen::VectorXd::Zero(1), number_};
  state.motion = &motion;
  ASSERT_TRUE(session_->Resume(kDriver, state).ok());
  EXPECT_NEAR(Frame(*session_, absl::Milliseconds(5100)), 0.2, kTolerance_m);
  // Dropped frames: the time since the last one counts.
  EXPECT_NEAR(Frame(*session_, absl::Milliseconds(5600)), 1.2, kTolerance_m);
  // A capture time that does not go on leaves no time to move.
  EXPECT_NEAR(Frame(*session_, absl::Milliseconds(5600)), 1.2, kTolerance_m);
  EXPECT_TRUE(solved_.needs_continuation);
}

TEST_F(SessionSpeedTest, WithoutCaptureTimesOrTheOptionNothingIsBounded) {
  Frame(*session_, absl::Seconds(1));
  ASSERT_TRUE(
      session_->Resume(kDriver, {Eigen::VectorXd::Zero(1), number_}).ok());
  EXPECT_NEAR(Frame(*session_, std::nullopt), 10, 1e-3);
  const auto free = Make(false);
  Frame(*free, absl::Seconds(1));
  ASSERT_TRUE(free->Resume(kDriver, {Eigen::VectorXd::Zero(1), number_}).ok());
  EXPECT_NEAR(Frame(*free, absl::Milliseconds(1001)), 10, 1e-3);
  EXPECT_FALSE(solved_.needs_continuation && solved_.bounds.lower.size() > 0);
}

TEST_F(SessionSpeedTest, AMotionOfAnotherBodyIsRefused) {
  JointMotion motion;
  motion.capture_time = absl::Seconds(5);
  motion.velocity = Eigen::VectorXd::Zero(2);
  ResumeState state{Eigen::VectorXd::Zero(1), 3};
  state.motion = &motion;
  const absl::Status status = session_->Resume(kDriver, state);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  motion.velocity = Eigen::VectorXd::Constant(1, std::nan(""));
  EXPECT_FALSE(session_->Resume(kDriver, state).ok());
}

}  // namespace
}  // namespace gelenk::server
