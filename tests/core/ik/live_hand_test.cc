// Live hands: targets at 72 Hz that run past the reach and through
// singularities, where streaming inverse kinematics is known to freeze and then
// lurch.
//
// Paths move the target by at most 2 cm and 3 degrees a frame. No frame may
// stand still while the target moves and there is still something to gain, no
// joint may go further than the stated bound a frame, and the answer has to be
// the closest pose there is.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/ik_targets.h"
#include "tests/testing/live_hands.h"

namespace gelenk {
namespace {

using testing::EffectorPose;
using testing::Hand;
using testing::LiveHands;
using testing::PoseGoalFor;
using testing::PositionGoalFor;
using testing::WayOutOf;

// A joint's bound a frame, rad: 7.2 rad/s.
constexpr double kMaxStep_rad = 0.1;
// The answer's distance to the target beyond the true one.
constexpr double kExcess_m = 1e-3;
constexpr double kTurnExcess_rad = 5e-3;
constexpr double kFrame_m = 0.02;

// Plays targets and remembers the worst of what must not happen.
class Stream {
 public:
  Stream(const Hand& hand, bool pose) : hand_(hand), positions_(hand.start) {
    const RigidTransform here =
        EffectorPose(*hand.skeleton, positions_, hand.tip());
    problem_ = std::make_unique<IkProblem>(*IkProblem::Create(
        hand.skeleton, {pose ? PoseGoalFor(hand.tip(), here)
                             : PositionGoalFor(hand.tip(), here.translation)}));
    options_.position_tolerance_m = 1e-5;
    options_.rotation_tolerance_rad = 1e-4;
    options_.max_step = kMaxStep_rad;
    options_.detail = ReportDetail::kBrief;
  }

  void Frame(const GoalTarget& target) {
    problem_->SetTarget(0, target);
    const Eigen::VectorXd before = positions_;
    solver_.Solve(*problem_, options_, SolveStart::kWarm, positions_, report_);
    Eigen::VectorXd change(hand_.skeleton->velocity_count());
    Difference(*hand_.skeleton, before, positions_, change);
    largest_step = std::max(largest_step, change.cwiseAbs().maxCoeff());
    stood_still = change.cwiseAbs().maxCoeff() == 0;
  }

  // The closest that a solver without bounds or memory gets from many starts.
  double TrueDistance_m() {
    SolverOptions options = options_;
    options.max_step.reset();
    options.max_restarts = 60;
    Eigen::VectorXd q = positions_;
    SolveReport report;
    IkSolver().Solve(*problem_, options, SolveStart::kCold, q, report);
    return report.position_errors_m[0];
  }

  double distance_m() const { return report_.position_errors_m[0]; }
  double turn_rad() const { return report_.rotation_errors_rad[0]; }
  const Eigen::VectorXd& positions() const { return positions_; }

  double largest_step = 0;
  bool stood_still = false;

 private:
  const Hand& hand_;
  Eigen::VectorXd positions_;
  std::unique_ptr<IkProblem> problem_;
  IkSolver solver_;
  SolverOptions options_;
  SolveReport report_;
};

class LiveHandTest : public ::testing::TestWithParam<int> {
 protected:
  const Hand hand_ = LiveHands()[GetParam()];
};

// Straight out past the boundary and back on the same line, slowly enough near
// the boundary for an elbow that bends with the square root of the way.
TEST_P(LiveHandTest, PastTheReachAndBack) {
  Stream stream(hand_, false);
  const auto [from, way] = WayOutOf(hand_);
  const double step_m = 0.001;
  const int out = 700;
  Eigen::Vector3d last = from;
  for (int i = 1; i <= 2 * out; ++i) {
    const int at = i <= out ? i : 2 * out - i;
    const Eigen::Vector3d target = from + at * step_m * way;
    ASSERT_LE((target - last).norm(), kFrame_m);
    last = target;
    stream.Frame(target);
    // What is left at a bound that is already straight may stand still; what
    // can be reached may not be given up.
    if (i % 50 == 0) {
      EXPECT_LE(stream.distance_m(), stream.TrueDistance_m() + kExcess_m)
          << hand_.name << " frame " << i;
    }
    EXPECT_FALSE(stream.stood_still && stream.distance_m() > kExcess_m &&
                 stream.TrueDistance_m() < stream.distance_m() - kExcess_m)
        << hand_.name << " froze in frame " << i;
  }
  EXPECT_LE(stream.largest_step, kMaxStep_rad + 1e-9);
  EXPECT_LE(stream.distance_m(), kExcess_m) << "came back";
}

// At full stretch an arm may bend either way, and on one of them a limit may
// wait.
TEST_P(LiveHandTest, ComesBackAtOtherSpeeds) {
  const auto [from, way] = WayOutOf(hand_);
  for (const int out : {130, 180, 250, 360, 500}) {
    Stream stream(hand_, false);
    for (int i = 1; i <= 2 * out; ++i) {
      const int at = i <= out ? i : 2 * out - i;
      const Eigen::Vector3d target = from + at * (0.7 / out) * way;
      stream.Frame(target);
    }
    EXPECT_LE(stream.largest_step, kMaxStep_rad + 1e-9);
    EXPECT_LE(stream.distance_m(), kExcess_m) << hand_.name << " in " << out;
  }
}

// Along the outside of the reach: the arm is stretched all the time.
TEST_P(LiveHandTest, AlongTheBoundary) {
  Stream stream(hand_, false);
  const Eigen::Vector3d base =
      EffectorPose(*hand_.skeleton, hand_.start, hand_.skeleton->joint(1).id)
          .translation;
  const Eigen::Vector3d from =
      EffectorPose(*hand_.skeleton, hand_.start, hand_.tip()).translation;
  Eigen::Vector3d target = from;
  const Eigen::Vector3d out = (from - base).normalized();
  for (int i = 0; i < 120; ++i) stream.Frame(target += 0.01 * out);
  const double radius = (target - base).norm();
  const Eigen::Vector3d side =
      out.cross(Eigen::Vector3d(0.3, 0.5, 1)).normalized();
  for (int i = 1; i <= 200; ++i) {
    const double angle = 0.006 * i;
    const Eigen::Vector3d next =
        base + radius * (std::cos(angle) * out + std::sin(angle) * side);
    ASSERT_LE((next - target).norm(), kFrame_m);
    target = next;
    stream.Frame(target);
    EXPECT_FALSE(stream.stood_still) << hand_.name << " froze in frame " << i;
    if (i % 40 == 0) {
      EXPECT_LE(stream.distance_m(), stream.TrueDistance_m() + kExcess_m)
          << hand_.name << " frame " << i;
    }
  }
  EXPECT_LE(stream.largest_step, kMaxStep_rad + 1e-9);
}

// Targets from joint paths that run through singular poses: there is an answer
// near the last one in every frame, and it has to be found.
void RunThrough(const Hand& hand,
                const std::function<Eigen::VectorXd(double)>& path,
                const std::string& what, int drop = 0) {
  Hand at = hand;
  at.start = path(0);
  Stream stream(at, true);
  constexpr int kFrames = 300;
  for (int i = 1; i <= kFrames; ++i) {
    // Dropped and bunched frames: a few come late, all at once.
    if (drop > 0 && i % (4 * drop) < drop) continue;
    const RigidTransform target = EffectorPose(
        *hand.skeleton, path(static_cast<double>(i) / kFrames), hand.tip());
    stream.Frame(target);
    EXPECT_LE(stream.distance_m(), kExcess_m)
        << hand.name << ", " << what << ", frame " << i;
    EXPECT_LE(stream.turn_rad(), kTurnExcess_rad)
        << hand.name << ", " << what << ", frame " << i;
  }
  EXPECT_LE(stream.largest_step, kMaxStep_rad + 1e-9) << hand.name << what;
}

TEST(LiveHandSingularityTest, Ur5WristElbowAndShoulder) {
  const Hand hand = LiveHands()[1];
  for (const int drop : {0, 1}) {
    for (const int joint : {4, 2}) {
      RunThrough(
          hand,
          [&](double t) {
            Eigen::VectorXd q = hand.start;
            // From one side of the singularity to the other, slowly enough for
            // 3 degrees a frame at the tip.
            q[joint] = 0.6 - 1.2 * t;
            q[0] += 0.4 * t;
            q[5] += 0.5 * std::sin(3 * t);
            return q;
          },
          joint == 4 ? "wrist" : "elbow", drop);
    }
  }
}

TEST(LiveHandSingularityTest, PandaWristAndShoulder) {
  const Hand hand = LiveHands()[0];
  for (const int joint : {5, 1}) {
    RunThrough(
        hand,
        [&](double t) {
          Eigen::VectorXd q = hand.start;
          q[joint] = joint == 5 ? 0.5 - 0.5 * t : -0.5 + t;
          q[0] += 0.5 * t;
          return q;
        },
        joint == 5 ? "wrist" : "shoulder");
  }
}

TEST(LiveHandSingularityTest, HumanElbowThroughStraight) {
  const Hand hand = LiveHands()[2];
  RunThrough(
      hand,
      [&](double t) {
        Eigen::VectorXd q = hand.start;
        q[4] = 0.6 * std::abs(1 - 2 * t);
        StoreXyzw(ExpRotation(Eigen::Vector3d(0.1, 0.3 + 0.5 * t, -0.4)),
                  &q[0]);
        return q;
      },
      "elbow");
}

INSTANTIATE_TEST_SUITE_P(Hands, LiveHandTest, ::testing::Values(0, 1, 2));

}  // namespace
}  // namespace gelenk
