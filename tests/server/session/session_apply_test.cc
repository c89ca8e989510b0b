// A frame is taken whole or not at all.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/session/session.h"
#include "tests/testing/example_sessions.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmSession;
using ::gelenk::testing::kAim;
using ::gelenk::testing::kGrip;
using ::gelenk::testing::kReach;
using ::gelenk::testing::ReachFrame;
using ::gelenk::testing::StateOf;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAreArray;

constexpr DriverId kDriver = 7;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
const absl::Time kNow = absl::FromUnixSeconds(1000);
const Eigen::Vector3d kPoint(1, 2, 3);
const Eigen::Quaterniond kTwice(2, 0, 0, 0);

std::shared_ptr<Session> DrivenSession() {
  auto session = ArmSession(kNow);
  EXPECT_TRUE(session->Claim(kDriver, false, kNow).ok());
  return session;
}

// State without the sequence number.
std::string ContentsOf(const Session& session) {
  const std::string state = StateOf(session);
  return state.substr(0, state.rfind('\n'));
}

std::vector<Goal> With(absl::Span<const Goal> goals, Goal more) {
  std::vector<Goal> result(goals.begin(), goals.end());
  result.push_back(std::move(more));
  return result;
}

struct Fault {
  std::string name;
  // Spoils a frame that moves "reach".
  std::function<void(InputFrame&)> spoil;
  std::vector<std::string> lines;
};

std::vector<Fault> Faults() {
  return {
      {"NotANumber",
       [](InputFrame& f) { f.updates[0].target = Eigen::Vector3d(kNan, 0, 0); },
       {"targets[0].world_position: want finite numbers, got (nan, 0, 0)"}},
      {"Infinite",
       [](InputFrame& f) {
         f.updates[0].target =
             Eigen::Vector3d(0, std::numeric_limits<double>::infinity(), 0);
       },
       {"targets[0].world_position: want finite numbers, got (0, inf, 0)"}},
      {"IndexTooLarge",
       [](InputFrame& f) {
         f.updates.push_back({3, kPoint, {}});
       },
       {"targets[1].goal_index: want 0 to 2, got 3"}},
      {"IndexNegative",
       [](InputFrame& f) {
         f.updates.push_back({-1, kPoint, {}});
       },
       {"targets[1].goal_index: want 0 to 2, got -1"}},
      {"WeightOfNoGoal",
       [](InputFrame& f) {
         f.updates.push_back({3, {}, 1.0});
       },
       {"targets[1].goal_index: want 0 to 2, got 3"}},
      {"PointForRotation",
       [](InputFrame& f) {
         f.updates.push_back({kAim, kPoint, {}});
       },
       {"targets[1].target: does not fit the rotation goal \"aim\""}},
      {"RotationForPoint",
       [](InputFrame& f) {
         f.updates[0].target = Eigen::Quaterniond::Identity();
       },
       {"targets[0].target: does not fit the position goal \"reach\""}},
      {"RotationNotUnit",
       [](InputFrame& f) {
         f.updates.push_back({kAim, kTwice, {}});
       },
       {"targets[1].world_rotation: want a unit quaternion, got (0, 0, 0, "
        "2)"}},
      {"PoseNotUnit",
       [](InputFrame& f) {
         f.updates.push_back({kGrip, RigidTransform{kTwice, kPoint}, {}});
       },
       {"targets[1].world_pose.rotation: want a unit quaternion, got (0, 0, "
        "0, 2)"}},
      {"WeightNegative",
       [](InputFrame& f) { f.updates[0].weight = -1; },
       {"targets[0].weight: want a finite number >= 0, got -1"}},
      {"WeightNotANumber",
       [](InputFrame& f) { f.updates[0].weight = kNan; },
       {"targets[0].weight: want a finite number >= 0, got nan"}},
      {"PlaceNotUnit",
       [](InputFrame& f) {
         f.world_from_skeleton = RigidTransform{kTwice, kPoint};
       },
       {"world_from_skeleton.rotation: want a unit quaternion, got (0, 0, 0, "
        "2)"}},
      {"PatchRefused",
       [](InputFrame& f) {
         f.patch = [](absl::Span<const Goal>) {
           return absl::StatusOr<std::vector<Goal>>(
               absl::InvalidArgumentError("no such patch"));
         };
       },
       {}},
      {"PatchWithGoalNowhere",
       [](InputFrame& f) {
         f.patch = [](absl::Span<const Goal> goals) {
           return absl::StatusOr<std::vector<Goal>>(
               With(goals, {"more", 1, PositionGoal{"nose", kPoint, {}}}));
         };
       },
       {"goals[3].position.end_effector_id: no end effector or joint "
        "\"nose\""}},
      {"GoodPatchBadTarget",
       [](InputFrame& f) {
         f.patch = [](absl::Span<const Goal> goals) {
           return absl::StatusOr<std::vector<Goal>>(
               With(goals, {"more", 1, PositionGoal{"j1", kPoint, {}}}));
         };
         f.updates.push_back({3, Eigen::Vector3d(kNan, kNan, kNan), {}});
       },
       {"targets[1].world_position: want finite numbers, got (nan, nan, "
        "nan)"}},
      {"SeveralAtOnce",
       [](InputFrame& f) {
         f.updates[0].weight = -2;
         f.updates.push_back({9, kPoint, {}});
         f.world_from_skeleton = RigidTransform{Eigen::Quaterniond::Identity(),
                                                Eigen::Vector3d(0, kNan, 0)};
       },
       {"targets[0].weight: want a finite number >= 0, got -2",
        "targets[1].goal_index: want 0 to 2, got 9",
        "world_from_skeleton.translation: want finite numbers, got (0, nan, "
        "0)"}},
  };
}

class SessionFaultTest : public ::testing::TestWithParam<Fault> {};

INSTANTIATE_TEST_SUITE_P(Frames, SessionFaultTest,
                         ::testing::ValuesIn(Faults()),
                         [](const auto& info) { return info.param.name; });

TEST_P(SessionFaultTest, NamesFieldAndValue) {
  const auto session = DrivenSession();
  InputFrame frame = ReachFrame(1, 0.4, 0.4);
  GetParam().spoil(frame);
  const absl::Status status = session->Apply(kDriver, frame, kNow);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(ViolationLines(status), ElementsAreArray(GetParam().lines))
      << status;
}

TEST_P(SessionFaultTest, ChangesNothing) {
  const auto session = DrivenSession();
  const std::string before = ContentsOf(*session);
  InputFrame frame = ReachFrame(1, 0.4, 0.4);
  GetParam().spoil(frame);
  ASSERT_FALSE(session->Apply(kDriver, frame, kNow).ok());
  EXPECT_EQ(ContentsOf(*session), before);

  // Not even what the next answer says.
  IkSolver solver;
  SolvedFrame solved;
  ASSERT_TRUE(session->Solve(kDriver, solver, true, solved).ok());
  const auto other = DrivenSession();
  SolvedFrame expected;
  ASSERT_TRUE(other->Solve(kDriver, solver, true, expected).ok());
  EXPECT_EQ(solved.positions, expected.positions);
  EXPECT_EQ(solved.needs_continuation, expected.needs_continuation);
}

TEST_P(SessionFaultTest, UsesUpItsSequenceNumber) {
  const auto session = DrivenSession();
  InputFrame bad = ReachFrame(5, 0.4, 0.4);
  GetParam().spoil(bad);
  ASSERT_FALSE(session->Apply(kDriver, bad, kNow).ok());
  EXPECT_EQ(session->sequence_number(), 5);
  InputFrame same = ReachFrame(5, 0.4, 0.4);
  EXPECT_FALSE(session->Apply(kDriver, same, kNow).ok());
  InputFrame next = ReachFrame(6, 0.4, 0.4);
  EXPECT_TRUE(session->Apply(kDriver, next, kNow).ok());
}

TEST(SessionApplyTest, RefusesSequenceNumbersThatDoNotGrow) {
  const auto session = DrivenSession();
  InputFrame first = ReachFrame(5, 0.4, 0.4);
  ASSERT_TRUE(session->Apply(kDriver, first, kNow).ok());
  const std::string before = StateOf(*session);
  for (int64_t old : {5, 4, 0, -1}) {
    InputFrame frame = ReachFrame(old, 0.9, 0.9);
    EXPECT_THAT(ViolationLines(session->Apply(kDriver, frame, kNow)),
                ElementsAreArray({absl::StrCat(
                    "sequence_number: want more than 5, got ", old)}));
  }
  EXPECT_EQ(StateOf(*session), before);
}

TEST(SessionApplyTest, TakesSequenceNumbersWithGaps) {
  const auto session = DrivenSession();
  for (int64_t number : {1, 2, 40, int{1} << 30}) {
    InputFrame frame = ReachFrame(number, 0.4, 0.4);
    EXPECT_TRUE(session->Apply(kDriver, frame, kNow).ok());
    EXPECT_EQ(session->sequence_number(), number);
  }
}

TEST(SessionApplyTest, TakesTargetsWeightsAndPlace) {
  const auto session = DrivenSession();
  InputFrame frame = ReachFrame(1, 0.4, 0.3);
  frame.updates.push_back({kAim, {}, 0.0});
  frame.world_from_skeleton =
      RigidTransform{Eigen::Quaterniond::Identity(), {0, 0, 5}};
  ASSERT_TRUE(session->Apply(kDriver, frame, kNow).ok());
  const SessionState state = session->Snapshot().state;
  EXPECT_EQ(std::get<PositionGoal>(state.goals[kReach].kind).world_position,
            Eigen::Vector3d(0.4, 0.3, 0));
  EXPECT_EQ(state.goals[kReach].weight, 1);
  EXPECT_EQ(state.goals[kAim].weight, 0);
  EXPECT_EQ(state.world_from_skeleton.translation.z(), 5);
}

TEST(SessionApplyTest, NormalizesWhatIsNearUnit) {
  const auto session = DrivenSession();
  InputFrame frame;
  frame.updates = {{kAim, Eigen::Quaterniond(1.0005, 0, 0, 0), {}}};
  ASSERT_TRUE(session->Apply(kDriver, frame, kNow).ok());
  EXPECT_EQ(std::get<RotationGoal>(session->Snapshot().state.goals[kAim].kind)
                .world_rotation.w(),
            1);
}

TEST(SessionApplyTest, TakesPatchBeforeTargets) {
  const auto session = DrivenSession();
  InputFrame frame;
  frame.patch = [](absl::Span<const Goal> goals) {
    return absl::StatusOr<std::vector<Goal>>(
        With(goals, {"elbow", 2, PositionGoal{"j1", kPoint, {}}}));
  };
  frame.updates = {{3, Eigen::Vector3d(0.5, 0.1, 0), {}}};
  ASSERT_TRUE(session->Apply(kDriver, frame, kNow).ok());
  const SessionState state = session->Snapshot().state;
  ASSERT_EQ(state.goals.size(), 4);
  EXPECT_EQ(std::get<PositionGoal>(state.goals[3].kind).world_position.x(),
            0.5);
}

TEST(SessionApplyTest, PatchKeepsWhereTheActorStands) {
  const auto session = DrivenSession();
  InputFrame move;
  move.world_from_skeleton =
      RigidTransform{Eigen::Quaterniond::Identity(), {1, 2, 3}};
  ASSERT_TRUE(session->Apply(kDriver, move, kNow).ok());
  InputFrame patch;
  patch.patch = [](absl::Span<const Goal> goals) {
    return absl::StatusOr<std::vector<Goal>>(
        std::vector<Goal>(goals.begin(), goals.begin() + 1));
  };
  ASSERT_TRUE(session->Apply(kDriver, patch, kNow).ok());
  EXPECT_EQ(session->Snapshot().state.world_from_skeleton.translation,
            Eigen::Vector3d(1, 2, 3));
}

TEST(SessionApplyTest, TakesAFrameThatSaysNothing) {
  const auto session = DrivenSession();
  const std::string before = ContentsOf(*session);
  InputFrame frame;
  frame.sequence_number = 1;
  EXPECT_TRUE(session->Apply(kDriver, frame, kNow).ok());
  EXPECT_EQ(ContentsOf(*session), before);
}

}  // namespace
}  // namespace gelenk::server
