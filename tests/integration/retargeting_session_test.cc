// Sessions that follow another body, over the wire: bits are those of the
// library, and of a stream that was never broken.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "gelenk/client/session_stream.h"
#include "gelenk/retarget/live_retargeter.h"
#include "tests/integration/follower_test.h"
#include "tests/testing/followed_body.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using testing::Actor;
using testing::AttachRequest;
using testing::BodyClip;
using testing::Fails;
using testing::FollowerRequest;
using ::testing::HasSubstr;
using testing::kPatience;
using ::testing::SizeIs;
using testing::SolveStream;
using testing::SourceFrame;
using testing::TrackedFrame;
using testing::TrackedRequest;
using v1::StreamEvent;

constexpr int kFrames = 90;
constexpr int kInvalidArgument = 3;
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

using Positions = std::vector<double>;

Positions PositionsOf(const v1::Pose& pose) {
  return {pose.positions().begin(), pose.positions().end()};
}

Positions PositionsOf(const Eigen::VectorXd& positions) {
  return {positions.begin(), positions.end()};
}

using MakeFrame = std::function<v1::TargetFrame(int number)>;

class RetargetingSessionTest : public FollowerTest {
 protected:
  static const Actor& Person() {
    static const auto* const kActor = new Actor(testing::WalkingActor(kFrames));
    return *kActor;
  }
  static v1::TargetFrame ClipFrame(int number) {
    return SourceFrame(Clip(), number);
  }
  static v1::TargetFrame PersonFrame(int number) {
    return TrackedFrame(Person(), number);
  }

  // Answers to frames `first` .. `last`.
  static std::vector<v1::PoseFrame> Play(SolveStream& stream,
                                         const MakeFrame& make_frame,
                                         int first = 1, int last = kFrames) {
    v1::StreamingSolveRequest request;
    for (int i = first; i <= last; ++i) *request.add_frames() = make_frame(i);
    EXPECT_TRUE(stream.Send(request));
    std::vector<v1::PoseFrame> answers = stream.NextFrames(last - first + 1);
    EXPECT_THAT(answers, SizeIs(last - first + 1));
    for (const v1::PoseFrame& answer : answers) {
      EXPECT_EQ(answer.status().code(), 0) << answer.status().message();
    }
    return answers;
  }

  static absl::Status CreateStatus(const v1::CreateSessionRequest& request) {
    return Call(&v1::SessionService::Stub::CreateSession, request).status();
  }

  // What the library does without a server.
  static std::vector<Positions> Offline() {
    LiveRetargetSpec spec;
    spec.source = Clip().model;
    spec.target = testing::HeroModel();
    spec.frame_time_s = Clip().frame_time_s;
    const auto live = *LiveRetargeter::Create(spec);
    std::vector<Positions> poses;
    for (int f = 0; f < kFrames; ++f) {
      live->NoteFrame(std::nullopt);
      live->Step(Clip().positions.col(f));
      poses.push_back(PositionsOf(live->positions()));
    }
    return poses;
  }

  // Resumed from the answer to frame `last`, a session goes on as `all`.
  static void ExpectExactResume(const std::string& session, int last,
                                const MakeFrame& make_frame,
                                const std::vector<v1::PoseFrame>& all) {
    v1::AttachSession attach = AttachRequest(session);
    *attach.mutable_resume_from() = all[last - 1];
    attach.set_take_over(true);
    const auto stream = OpenStream();
    ASSERT_TRUE(stream->Attach(attach));
    const auto event = stream->NextNews();
    ASSERT_TRUE(event && event->kind() == StreamEvent::KIND_ATTACHED);
    EXPECT_EQ(event->status().code(), 0) << event->status().message();
    const auto answers = Play(*stream, make_frame, last + 1);
    for (int i = last; i < kFrames; ++i) {
      ASSERT_EQ(PositionsOf(answers[i - last].pose()),
                PositionsOf(all[i].pose()))
          << "resumed from " << last << ", frame " << i + 1;
    }
  }
};

TEST_F(RetargetingSessionTest, AStreamIsTheLibraryBitByBit) {
  const auto stream =
      OpenStream({AttachRequest(CreateSession(FollowerRequest(Clip())))});
  const auto answers = Play(*stream, ClipFrame);
  const std::vector<Positions> offline = Offline();
  for (int i = 0; i < kFrames; ++i) {
    ASSERT_EQ(PositionsOf(answers[i].pose()), offline[i]) << i + 1;
    EXPECT_TRUE(answers[i].has_retarget_report());
    EXPECT_LT(answers[i].retarget_report().left_foot_error_m(), 1e-3);
  }
}

TEST_F(RetargetingSessionTest, SingleSolvesAreTheSame) {
  const std::string name = CreateSession(FollowerRequest(Clip()));
  const std::vector<Positions> offline = Offline();
  for (int i = 1; i <= 20; ++i) {
    v1::SolveSessionRequest request;
    request.set_name(name);
    *request.mutable_source_pose() = ClipFrame(i).source_pose();
    const auto solved = Call(&v1::SessionService::Stub::SolveSession, request);
    ASSERT_TRUE(solved.ok()) << solved.status();
    ASSERT_EQ(PositionsOf(solved->pose()), offline[i - 1]) << i;
    EXPECT_TRUE(solved->has_retarget_report());
  }
  v1::SolveSessionRequest request;
  request.set_name(name);
  EXPECT_THAT(Call(&v1::SessionService::Stub::SolveSession, request).status(),
              Fails(kInvalid, "source_pose: want a pose of skeletons/walker"));
}

TEST_F(RetargetingSessionTest, ResumeIsExact) {
  const std::string old = CreateSession(FollowerRequest(Clip()));
  const auto stream = OpenStream({AttachRequest(old)});
  const auto all = Play(*stream, ClipFrame);
  for (int last : {1, 2, 17, 45, kFrames - 1}) {
    ExpectExactResume(CreateSession(FollowerRequest(Clip())), last, ClipFrame,
                      all);
    ExpectExactResume(old, last, ClipFrame, all);
  }
}

TEST_F(RetargetingSessionTest, ResumeWithoutContinuationSaysSo) {
  const auto stream =
      OpenStream({AttachRequest(CreateSession(FollowerRequest(Clip())))});
  v1::PoseFrame last = Play(*stream, ClipFrame, 1, 10).back();
  last.clear_continuation();
  v1::AttachSession attach =
      AttachRequest(CreateSession(FollowerRequest(Clip())));
  *attach.mutable_resume_from() = last;
  const auto resumed = OpenStream();
  ASSERT_TRUE(resumed->Attach(attach));
  const auto event = resumed->NextNews();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind(), StreamEvent::KIND_ATTACHED);
  EXPECT_THAT(event->status().message(), HasSubstr("not exact"));
}

TEST_F(RetargetingSessionTest, AViewerSeesTheTarget) {
  const std::string name = CreateSession(FollowerRequest(Clip()));
  const auto stream = OpenStream({AttachRequest(name)});
  const auto answers = Play(*stream, ClipFrame, 1, 30);
  grpc::ClientContext context;
  v1::WatchSessionRequest request;
  request.set_name(name);
  const auto viewer = connection().sessions().WatchSession(&context, request);
  v1::WatchSessionResponse seen;
  ASSERT_TRUE(viewer->Read(&seen));
  EXPECT_EQ(seen.sequence_number(), 30);
  EXPECT_EQ(PositionsOf(seen.pose()), PositionsOf(answers.back().pose()));
  context.TryCancel();
}

const v1::JointPair* FindPair(const v1::Session& session, v1::BodyRole role) {
  for (const v1::JointPair& pair : session.retargeting().joint_map().pairs()) {
    if (pair.role() == role) return &pair;
  }
  return nullptr;
}

TEST_F(RetargetingSessionTest, TheMapIsReportedAndOverridden) {
  v1::CreateSessionRequest request = FollowerRequest(Clip());
  v1::JointPair* given = request.mutable_session()
                             ->mutable_retargeting()
                             ->mutable_joint_map()
                             ->add_pairs();
  given->set_role(v1::BODY_ROLE_LEFT_TOE);
  given->set_target_joint_id("");
  const auto session = Call(&v1::SessionService::Stub::CreateSession, request);
  ASSERT_TRUE(session.ok()) << session.status();
  const v1::JointPair* hand = FindPair(*session, v1::BODY_ROLE_LEFT_HAND);
  ASSERT_NE(hand, nullptr);
  EXPECT_EQ(hand->source_joint_id(), "LeftHand");
  EXPECT_EQ(hand->target_joint_id(), "left_hand");
  const v1::JointPair* toe = FindPair(*session, v1::BODY_ROLE_LEFT_TOE);
  EXPECT_TRUE(toe == nullptr || !toe->has_target_joint_id());
  EXPECT_EQ(session->retargeting().source_skeleton(), "skeletons/walker");
  EXPECT_EQ(session->retargeting().frame_time_s(), Clip().frame_time_s);
}

TEST_F(RetargetingSessionTest, ASkeletonThatIsFollowedStays) {
  CreateSession(FollowerRequest(Clip()));
  v1::DeleteSkeletonRequest request;
  request.set_name("skeletons/walker");
  EXPECT_EQ(Call(&v1::KinematicsService::Stub::DeleteSkeleton, request)
                .status()
                .code(),
            absl::StatusCode::kFailedPrecondition);
}

TEST_F(RetargetingSessionTest, BadSessionsAreNamed) {
  using Retargeting = v1::Retargeting;
  const auto refuse = [](const std::function<void(Retargeting&)>& change,
                         const char* words) {
    v1::CreateSessionRequest request = FollowerRequest(Clip());
    change(*request.mutable_session()->mutable_retargeting());
    EXPECT_THAT(CreateStatus(request), Fails(kInvalid, words));
  };
  refuse([](Retargeting& r) { r.clear_source_skeleton(); },
         "session.retargeting: want source_skeleton or trackers");
  refuse([](Retargeting& r) { r.mutable_trackers(); }, "got both");
  refuse([](Retargeting& r) { r.set_source_skeleton("walker"); },
         "retargeting.source_skeleton");
  refuse([](Retargeting& r) { r.set_root_scale(-2); }, "root_scale");
  refuse([](Retargeting& r) { r.set_frame_time_s(0); }, "frame_time_s");
  refuse(
      [](Retargeting& r) {
        r.mutable_contact_thresholds()->set_max_speed_on_m_per_s(9);
      },
      "session.retargeting.contact_thresholds: max_speed: on at 9");
  refuse(
      [](Retargeting& r) {
        v1::JointPair* pair = r.mutable_joint_map()->add_pairs();
        pair->set_role(v1::BODY_ROLE_HEAD);
        pair->set_source_joint_id("Tail");
      },
      "session.retargeting.joint_map");
  refuse(
      [](Retargeting& r) {
        r.mutable_source_calibration()->mutable_positions()->RemoveLast();
      },
      "session.retargeting.source_calibration.positions: want a multiple of");
  refuse(
      [](Retargeting& r) {
        r.mutable_source_calibration()->set_first_frame(kFrames);
      },
      "source_calibration.first_frame: want 0 to 89, got 90");
  refuse(
      [](Retargeting& r) {
        r.mutable_target_calibration()->mutable_reference_pose()->add_positions(
            1);
      },
      "session.retargeting.target_calibration.reference_pose");

  v1::CreateSessionRequest absent = FollowerRequest(Clip());
  absent.mutable_session()->mutable_retargeting()->set_source_skeleton(
      "skeletons/nobody");
  EXPECT_EQ(CreateStatus(absent).code(), absl::StatusCode::kNotFound);

  v1::CreateSessionRequest with_goals = FollowerRequest(Clip());
  *with_goals.mutable_session()->mutable_goals() =
      TrackedRequest().session().goals();
  EXPECT_THAT(CreateStatus(with_goals), Fails(kInvalid, "session.goals: want"));
}

TEST_F(RetargetingSessionTest, BadFramesChangeNothing) {
  using Frame = v1::TargetFrame;
  struct Fault {
    std::function<void(Frame&)> commit;
    std::string told;
  };
  const std::vector<Fault> faults = {
      {[](Frame& f) { f.clear_source_pose(); }, "source_pose: want a pose"},
      {[](Frame& f) {
         f.mutable_source_pose()->mutable_positions()->RemoveLast();
       },
       "source_pose.positions"},
      {[](Frame& f) {
         f.mutable_source_pose()->set_positions(
             5, std::numeric_limits<double>::quiet_NaN());
       },
       "source_pose.positions[5]"},
      {[](Frame& f) { f.mutable_source_pose()->set_positions(4, 7); },
       "source_pose.positions"},
      {[](Frame& f) { f.add_targets()->set_weight(1); }, "targets[0]"}};
  const auto stream =
      OpenStream({AttachRequest(CreateSession(FollowerRequest(Clip())))});
  const std::vector<Positions> offline = Offline();
  // Numbers are used up, so frames of the clip are numbered anew.
  int number = 0;
  const auto next = [&](const Frame& content) {
    Frame frame = content;
    frame.set_sequence_number(++number);
    EXPECT_TRUE(stream->SendFrame(frame));
    return stream->NextFrame().value_or(v1::PoseFrame());
  };
  for (int i = 1; i <= 20; ++i) {
    const Fault& fault = faults[i % faults.size()];
    Frame bad = ClipFrame(i);
    fault.commit(bad);
    const v1::PoseFrame refused = next(bad);
    EXPECT_EQ(refused.status().code(), kInvalidArgument) << fault.told;
    EXPECT_THAT(refused.status().message(), HasSubstr(fault.told));
    ASSERT_EQ(PositionsOf(next(ClipFrame(i)).pose()), offline[i - 1]) << i;
  }
}

TEST_F(RetargetingSessionTest, TimeThatRunsBackIsRefused) {
  const auto stream =
      OpenStream({AttachRequest(CreateSession(FollowerRequest(Clip())))});
  v1::TargetFrame frame = ClipFrame(1);
  frame.mutable_capture_time()->set_seconds(8);
  ASSERT_TRUE(stream->SendFrame(frame));
  EXPECT_EQ(stream->NextFrame()->status().code(), 0);
  frame.set_sequence_number(2);
  frame.mutable_capture_time()->set_seconds(7);
  ASSERT_TRUE(stream->SendFrame(frame));
  EXPECT_THAT(stream->NextFrame()->status().message(),
              HasSubstr("capture_time: want after 8s, got 7s"));
}

TEST_F(RetargetingSessionTest, ASessionThatSolvesForGoalsTakesNoSource) {
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  ASSERT_TRUE(stream->SendFrame(ClipFrame(1)));
  EXPECT_THAT(stream->NextFrame()->status().message(),
              HasSubstr("source_pose: the session has no retargeting"));
}

TEST_F(RetargetingSessionTest, TrackersAreTheLibraryAndResumeExactly) {
  const auto stream =
      OpenStream({AttachRequest(CreateSession(TrackedRequest()))});
  const auto all = Play(*stream, PersonFrame);
  LiveRetargetSpec spec;
  spec.trackers.emplace();
  spec.target = testing::HeroModel();
  const auto live = *LiveRetargeter::Create(spec);
  for (int f = 0; f < kFrames; ++f) {
    live->NoteFrame(std::nullopt);
    live->Step(
        testing::TrackersOn(*Person().model, Person().positions.col(f), true));
    ASSERT_EQ(PositionsOf(all[f].pose()), PositionsOf(live->positions())) << f;
  }
  for (int last : {1, 40}) {
    ExpectExactResume(CreateSession(TrackedRequest()), last, PersonFrame, all);
  }
}

TEST_F(RetargetingSessionTest, ALostTrackerIsHeld) {
  const auto stream =
      OpenStream({AttachRequest(CreateSession(TrackedRequest()))});
  v1::TargetFrame headless;
  headless.set_sequence_number(1);
  ASSERT_TRUE(stream->SendFrame(headless));
  EXPECT_THAT(stream->NextFrame()->status().message(),
              HasSubstr("targets: the head has never been tracked"));
  const auto make_frame = [](int number) {
    v1::TargetFrame frame = PersonFrame(number - 1);
    frame.set_sequence_number(number);
    if (number != 30) return frame;
    for (v1::GoalTarget& target : *frame.mutable_targets()) {
      target.set_weight(target.goal_index() == 1 ? 0 : 1);
    }
    return frame;
  };
  const auto answers = Play(*stream, make_frame, 2, 40);
  // The hand goes on with the body: no jump.
  for (size_t i = 1; i < answers.size(); ++i) {
    const Positions before = PositionsOf(answers[i - 1].pose());
    const Positions now = PositionsOf(answers[i].pose());
    for (size_t k = 0; k < now.size(); ++k) {
      ASSERT_LT(std::abs(now[k] - before[k]), 0.2) << i << ", " << k;
    }
  }
}

TEST_F(RetargetingSessionTest, BadTrackersAreNamed) {
  v1::CreateSessionRequest request = TrackedRequest();
  request.mutable_session()->mutable_goals(2)->set_goal_id("tail");
  EXPECT_THAT(CreateStatus(request),
              Fails(kInvalid, "session.goals[2].goal_id"));
  request = TrackedRequest();
  v1::Trackers* trackers =
      request.mutable_session()->mutable_retargeting()->mutable_trackers();
  trackers->set_height_m(40);
  EXPECT_THAT(CreateStatus(request), Fails(kInvalid, "height_m"));
  trackers->set_height_m(1.7);
  trackers->add_t_pose()->set_goal_id("tail");
  EXPECT_THAT(CreateStatus(request),
              Fails(kInvalid, "retargeting.trackers.t_pose[0].goal_id"));
}

// The client library brings skeletons, session and memory back.
TEST(FollowedStreamTest, AKilledServerShowsInNoAngle) {
  const BodyClip clip = testing::WalkClip(kFrames);
  testing::ServerProcess server(GELENKD, {"--log-level", "error"});
  ASSERT_EQ(server.Start(), absl::OkStatus());
  client::SessionSpec spec;
  spec.skeleton = testing::HeroRequest();
  spec.source_skeleton = testing::WalkerRequest(clip);
  // Both streams make the same skeletons.
  spec.skeleton.set_request_id("hero");
  spec.source_skeleton.set_request_id("walker");
  spec.session = FollowerRequest(clip);
  spec.frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
  std::vector<Positions> answers[2];
  for (const bool disturbed : {false, true}) {
    spec.session.set_session_id(disturbed ? "disturbed" : "undisturbed");
    auto stream = client::SessionStream::Open(
        std::make_shared<client::Connection>(server.target()), {}, {spec});
    ASSERT_TRUE(stream.ok()) << stream.status();
    for (int i = 1; i <= kFrames; ++i) {
      ASSERT_TRUE((*stream)->Send(SourceFrame(clip, i), kPatience).ok());
      const auto answer = (*stream)->Receive(kPatience);
      ASSERT_TRUE(answer.ok() && answer->has_value()) << i;
      ASSERT_EQ((*answer)->status().code(), 0) << (*answer)->DebugString();
      answers[disturbed].push_back(PositionsOf((*answer)->pose()));
      if (!disturbed || (i != 1 && i != 40)) continue;
      server.Kill();
      ASSERT_EQ(server.Start(), absl::OkStatus());
    }
    EXPECT_EQ((*stream)->statistics().inexact_resumes, 0);
    EXPECT_EQ((*stream)->statistics().recreated_sessions, disturbed ? 2 : 0);
  }
  EXPECT_EQ(answers[0], answers[1]);
}

}  // namespace
}  // namespace gelenk
