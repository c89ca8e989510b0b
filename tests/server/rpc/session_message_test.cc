#include "server/rpc/session_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/testing/example_sessions.h"
#include "tests/testing/example_skeletons.h"
#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ArmSession;
using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const absl::Time kNow = absl::FromUnixSeconds(1000);

std::shared_ptr<const Skeleton> Arm() {
  return gelenk::testing::PlanarChain(Eigen::Vector3d::Zero(), {0.5, 0.5, 0.5});
}

v1::Session ArmMessage() {
  v1::Session proto;
  ToProto(*ArmSession(kNow), /*draining=*/false, &proto);
  return proto;
}

absl::StatusOr<SessionState> StateOfMessage(const v1::Session& proto,
                                            const Limits& limits = {}) {
  SessionState state;
  const absl::Status status = StateFromProto(proto, *Arm(), limits, state);
  if (!status.ok()) return status;
  return state;
}

SessionState ArmState() { return ArmSession(kNow)->Snapshot().state; }

// --- Time ---

TEST(SessionMessageTest, TimesAreUnixTimes) {
  google::protobuf::Timestamp proto;
  ToProto(absl::FromUnixSeconds(1700000000) + absl::Nanoseconds(5), &proto);
  EXPECT_EQ(proto.seconds(), 1700000000);
  EXPECT_EQ(proto.nanos(), 5);
}

// --- The whole message ---

TEST(SessionMessageTest, SaysEverythingOfASession) {
  const v1::Session proto = ArmMessage();
  EXPECT_EQ(proto.name(), "sessions/arm");
  EXPECT_EQ(proto.skeleton(), "skeletons/arm");
  EXPECT_EQ(proto.affinity_key(), "arm");
  EXPECT_EQ(proto.goals_size(), 3);
  EXPECT_EQ(proto.pose().positions_size(), 3);
  EXPECT_TRUE(proto.has_solver_options());
  EXPECT_TRUE(proto.has_world_from_skeleton());
  EXPECT_EQ(proto.idle_ttl().seconds(), 600);
  EXPECT_EQ(proto.create_time().seconds(), 1000);
  EXPECT_EQ(proto.expire_time().seconds(), 1600);
  EXPECT_EQ(proto.state(), v1::Session::STATE_ACTIVE);
  EXPECT_EQ(proto.etag(), "r1");
}

TEST(SessionMessageTest, SaysThatTheServerDrains) {
  v1::Session proto;
  ToProto(*ArmSession(kNow), /*draining=*/true, &proto);
  EXPECT_EQ(proto.state(), v1::Session::STATE_DRAINING);
}

TEST(SessionMessageTest, ComesRound) {
  const v1::Session proto = ArmMessage();
  const auto state = StateOfMessage(proto);
  ASSERT_TRUE(state.ok()) << state.status();
  const auto session = ArmSession(kNow, state->goals, *state);
  v1::Session again;
  ToProto(*session, /*draining=*/false, &again);
  EXPECT_EQ(again.DebugString(), proto.DebugString());
}

TEST(SessionMessageTest, WithoutAPoseStartsColdFromTheRestPose) {
  v1::Session proto = ArmMessage();
  EXPECT_FALSE(StateOfMessage(proto)->cold);
  proto.clear_pose();
  const auto state = StateOfMessage(proto);
  EXPECT_TRUE(state->cold);
  EXPECT_EQ(state->positions, Arm()->rest_positions());
}

TEST(SessionMessageTest, EmptyMessageMeansDefaults) {
  Limits limits;
  limits.default_idle_ttl = absl::Minutes(3);
  const auto state = StateOfMessage({}, limits);
  ASSERT_TRUE(state.ok()) << state.status();
  EXPECT_EQ(state->idle_ttl, absl::Minutes(3));
  EXPECT_TRUE(state->goals.empty());
  EXPECT_EQ(state->world_from_skeleton.translation, Eigen::Vector3d::Zero());
}

TEST(SessionMessageTest, ListsEveryViolation) {
  v1::Session proto = ArmMessage();
  proto.mutable_goals(1)->clear_kind();
  proto.mutable_solver_options()->set_max_iterations(-1);
  proto.mutable_pose()->add_positions(1);
  proto.mutable_world_from_skeleton()->mutable_rotation()->set_w(3);
  proto.mutable_idle_ttl()->set_seconds(-1);
  const auto lines = ViolationLines(StateOfMessage(proto).status());
  EXPECT_THAT(
      lines,
      ElementsAre(
          "goals[1].kind: goal \"aim\" wishes nothing",
          HasSubstr("solver_options.max_iterations: "),
          HasSubstr("pose.positions: "),
          "world_from_skeleton.rotation: want a unit quaternion, got (0, 0, "
          "0, 3)",
          "idle_ttl: want more than 0, got -1s"));
}

TEST(SessionMessageTest, IdleTtlIsCappedByTheServer) {
  Limits limits;
  limits.max_idle_ttl = absl::Minutes(5);
  v1::Session proto;
  const auto ttl = [&] { return StateOfMessage(proto, limits)->idle_ttl; };
  EXPECT_EQ(ttl(), absl::Minutes(5)) << "so is the default";
  proto.mutable_idle_ttl()->set_seconds(300);
  EXPECT_EQ(ttl(), absl::Minutes(5));
  proto.mutable_idle_ttl()->set_seconds(301);
  EXPECT_EQ(ttl(), absl::Minutes(5));
  proto.mutable_idle_ttl()->set_seconds(299);
  EXPECT_EQ(ttl(), absl::Seconds(299));
  proto.mutable_idle_ttl()->set_seconds(std::numeric_limits<int64_t>::max());
  EXPECT_EQ(ttl(), absl::Minutes(5));
}

TEST(SessionMessageTest, IdleTtlOfNothingIsRefused) {
  v1::Session proto;
  proto.mutable_idle_ttl();
  EXPECT_THAT(ViolationLines(StateOfMessage(proto).status()),
              ElementsAre("idle_ttl: want more than 0, got 0"));
  proto.mutable_idle_ttl()->set_nanos(1);
  EXPECT_TRUE(StateOfMessage(proto).ok());
}

// --- Updates ---

class UpdateStateTest : public ::testing::Test {
 protected:
  UpdateStateTest() {
    v1::Session* session = request_.mutable_session();
    v1::Goal* goal = session->add_goals();
    goal->set_goal_id("only");
    goal->mutable_position()->set_end_effector_id("tip");
    session->mutable_solver_options()->set_max_iterations(7);
    for (double q : {0.7, 0.8, 0.9}) {
      session->mutable_pose()->add_positions(q);
    }
    session->mutable_world_from_skeleton()->mutable_translation()->set_z(4);
    session->mutable_idle_ttl()->set_seconds(60);
  }

  absl::Status Update() {
    return UpdateState(request_, *Arm(), Limits(), state_);
  }
  // Which parts of the state are the request's now.
  std::string Changed() {
    std::string changed;
    if (state_.goals.size() == 1) changed += " goals";
    if (state_.options.max_iterations == 7) changed += " solver_options";
    if (state_.positions[0] == 0.7) changed += " pose";
    if (state_.world_from_skeleton.translation.z() == 4) changed += " place";
    if (state_.idle_ttl == absl::Seconds(60)) changed += " idle_ttl";
    return changed;
  }

  v1::UpdateSessionRequest request_;
  SessionState state_ = ArmState();
};

TEST_F(UpdateStateTest, ReplacesWhatTheMaskNames) {
  request_.mutable_update_mask()->add_paths("goals");
  request_.mutable_update_mask()->add_paths("idle_ttl");
  ASSERT_TRUE(Update().ok());
  EXPECT_EQ(Changed(), " goals idle_ttl");
}

TEST_F(UpdateStateTest, WithoutMaskReplacesWhatIsPopulated) {
  request_.mutable_session()->clear_goals();
  request_.mutable_session()->clear_pose();
  ASSERT_TRUE(Update().ok());
  EXPECT_EQ(Changed(), " solver_options place idle_ttl");
}

TEST_F(UpdateStateTest, WithoutAnythingReplacesNothing) {
  request_.Clear();
  ASSERT_TRUE(Update().ok());
  EXPECT_EQ(Changed(), "");
}

TEST_F(UpdateStateTest, AStarReplacesEverything) {
  request_.mutable_update_mask()->add_paths("*");
  ASSERT_TRUE(Update().ok());
  EXPECT_EQ(Changed(), " goals solver_options pose place idle_ttl");
}

TEST_F(UpdateStateTest, AStarResetsWhatIsUnset) {
  request_.mutable_session()->Clear();
  request_.mutable_update_mask()->add_paths("*");
  ASSERT_TRUE(Update().ok());
  EXPECT_TRUE(state_.goals.empty());
  EXPECT_TRUE(state_.cold);
  EXPECT_EQ(state_.idle_ttl, absl::Minutes(10));
}

TEST_F(UpdateStateTest, RefusesOtherFields) {
  request_.mutable_update_mask()->add_paths("goals");
  request_.mutable_update_mask()->add_paths("skeleton");
  EXPECT_THAT(ViolationLines(Update()),
              ElementsAre("update_mask: no field \"skeleton\" can be updated"));
}

// Goals that stand beside a bad part can be looked at, too.
TEST_F(UpdateStateTest, ABadPartIsLeftOut) {
  request_.mutable_update_mask()->add_paths("*");
  request_.mutable_session()->mutable_pose()->add_positions(1);
  EXPECT_THAT(ViolationLines(Update()),
              ElementsAre(HasSubstr("session.pose.positions: ")));
  EXPECT_EQ(Changed(), " goals solver_options place idle_ttl");
}

// --- Etags ---

TEST(EtagTest, ComesRound) {
  EXPECT_EQ(RevisionOf(ArmMessage().etag()).value(), 1);
  EXPECT_EQ(RevisionOf("r123").value(), 123);
}

TEST(EtagTest, EmptyOneAsksForNothing) {
  EXPECT_EQ(RevisionOf("").value(), std::nullopt);
}

TEST(EtagTest, OthersAreRefused) {
  for (const char* etag :
       {"r", "123", "rx", "W/\"1\"", "r99999999999999999999"}) {
    EXPECT_THAT(ViolationLines(RevisionOf(etag).status()),
                ElementsAre("session.etag: is none of this server's"))
        << etag;
  }
}

}  // namespace
}  // namespace gelenk::server
