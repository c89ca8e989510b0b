// Clips processed, measured, retargeted, played and recorded over the wire.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "tests/integration/clip_service_test.h"
#include "tests/testing/status_matchers.h"

namespace gelenk {
namespace {

using ::testing::Contains;
using testing::Fails;
using ::testing::HasSubstr;

class MotionCallsTest : public ClipServiceTest {
 protected:
  static v1::Clip Walk(int frames = 120, const std::string& skeleton = "") {
    const auto clip = CreateWalk(frames, skeleton);
    EXPECT_TRUE(clip.ok()) << clip.status();
    return clip.value_or(v1::Clip());
  }

  static v1::ProcessClipRequest Process(const v1::Clip& clip) {
    v1::ProcessClipRequest request;
    request.set_clip(clip.name());
    return request;
  }

  // All frames that PlayClips sends, at most `most`.
  struct Played {
    std::vector<v1::PlayedFrame> frames;
    int message_count = 0;
    int skipped = 0;
    absl::Status status;
  };
  static Played Play(const v1::PlayClipsRequest& request,
                     size_t most = 100000) {
    grpc::ClientContext context;
    client::CallOptions options;
    options.timeout = testing::kPatience;
    connection().Prepare(options, context);
    const auto reader = connection().motion().PlayClips(&context, request);
    Played played;
    v1::PlayClipsResponse response;
    while (played.frames.size() < most && reader->Read(&response)) {
      ++played.message_count;
      played.skipped += response.skipped_frame_count();
      played.frames.insert(played.frames.end(), response.frames().begin(),
                           response.frames().end());
    }
    if (played.frames.size() >= most) context.TryCancel();
    played.status = client::FromGrpc(reader->Finish());
    return played;
  }
  static v1::PlayClipsRequest PlayRequest(const v1::Clip& clip) {
    v1::PlayClipsRequest request;
    request.add_layers()->set_clip(clip.name());
    return request;
  }
};

TEST_F(MotionCallsTest, StepsAreDoneInOrder) {
  const v1::Clip walk = Walk();
  v1::ProcessClipRequest request = Process(walk);
  request.set_display_name("half a walk");
  request.add_steps()->mutable_low_pass()->set_cutoff_hz(5);
  request.add_steps()->mutable_mirror();
  v1::Crop* crop = request.add_steps()->mutable_crop();
  crop->set_start_s(0.2);
  crop->set_end_s(1.2);
  request.add_steps()->mutable_resample()->set_frame_time_s(0.01);
  const auto made = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_NE(made->name(), walk.name());
  EXPECT_EQ(made->display_name(), "half a walk");
  EXPECT_EQ(made->skeleton(), walk.skeleton());
  EXPECT_NEAR(made->duration_s(), 1, 1e-9);
  EXPECT_EQ(made->frame_time_s(), 0.01);
  // The form of the file goes with it.
  EXPECT_THAT(Export(made->name(), v1::CLIP_FORMAT_BVH).data,
              HasSubstr("ROOT Hips"));
}

// A recording behind a T-pose, as conversions leave it.
TEST_F(MotionCallsTest, AFilterLeavesOutWhatIsNoPartOfTheMotion) {
  const auto raw = CreateWalkBehindATPose(60);
  ASSERT_TRUE(raw.ok()) << raw.status();
  v1::ProcessClipRequest request = Process(*raw);
  request.add_steps()->mutable_low_pass()->set_cutoff_hz(6);
  const auto smooth = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(smooth.ok()) << smooth.status();
  EXPECT_NEAR(smooth->duration_s(), raw->duration_s() - raw->frame_time_s(),
              1e-9);
  EXPECT_THAT(smooth->warnings(),
              Contains(HasSubstr("frame 0 is no part of the motion")));
  v1::MeasureClipRequest measure;
  measure.set_clip(smooth->name());
  measure.set_reference_clip(raw->name());
  const auto measured = Call(&Stub::MeasureClip, measure);
  ASSERT_TRUE(measured.ok()) << measured.status();
  EXPECT_LE(measured->comparison().jerk_ratio(), 1);
}

TEST_F(MotionCallsTest, LayersAndDifferencesGiveAMotionBack) {
  const v1::Clip walk = Walk();
  const v1::Clip other = Walk(120, walk.skeleton());
  v1::ProcessClipRequest request = Process(other);
  request.add_steps()->mutable_mirror();
  const auto mirrored = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(mirrored.ok()) << mirrored.status();
  request = Process(*mirrored);
  request.add_steps()->mutable_difference()->set_clip(walk.name());
  const auto difference = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(difference.ok()) << difference.status();
  request = Process(walk);
  v1::ClipLayer* layer = request.add_steps()->mutable_layers()->add_layers();
  layer->set_clip(difference->name());
  layer->set_mode(v1::ClipLayer::MODE_ADDITIVE);
  const auto again = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(again.ok()) << again.status();
  const Played wanted = Play(PlayRequest(*mirrored));
  const Played got = Play(PlayRequest(*again));
  ASSERT_EQ(got.frames.size(), wanted.frames.size());
  for (size_t i = 0; i < got.frames.size(); i += 10) {
    for (int k = 0; k < got.frames[i].pose().positions_size(); ++k) {
      EXPECT_NEAR(std::abs(got.frames[i].pose().positions(k)),
                  std::abs(wanted.frames[i].pose().positions(k)), 1e-9);
    }
  }
}

TEST_F(MotionCallsTest, GaitsBlendStepByStep) {
  const v1::Clip walk = Walk(150);
  v1::ProcessClipRequest request = Process(walk);
  v1::WarpCurve* curve =
      request.add_steps()->mutable_time_warp()->mutable_curve();
  curve->add_keys();
  v1::WarpKey* end = curve->add_keys();
  end->set_time_s(1.49);
  end->set_clip_time_s(walk.duration_s());
  const auto fast = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(fast.ok()) << fast.status();
  request = Process(walk);
  v1::BlendGait* blend = request.add_steps()->mutable_blend_gait();
  blend->set_clip(fast->name());
  blend->set_part(0.5);
  const auto made = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_GT(made->duration_s(), 0.5);
  request = Process(walk);
  request.add_steps()->mutable_time_warp()->set_strikes_of_clip(fast->name());
  EXPECT_TRUE(Call(&Stub::ProcessClip, request).ok());
}

TEST_F(MotionCallsTest, PlantedFeetAreMeasuredBesideTheirSource) {
  const v1::Clip walk = Walk();
  v1::ProcessClipRequest request = Process(walk);
  request.add_steps()->mutable_plant_feet();
  const auto planted = Call(&Stub::ProcessClip, request);
  ASSERT_TRUE(planted.ok()) << planted.status();
  v1::MeasureClipRequest measure;
  measure.set_clip(planted->name());
  measure.set_reference_clip(walk.name());
  const auto measured = Call(&Stub::MeasureClip, measure);
  ASSERT_TRUE(measured.ok()) << measured.status();
  EXPECT_LE(measured->quality().max_penetration_m(), 1e-3);
  EXPECT_GT(measured->reference_quality().jerk_m_s3(), 0);
  EXPECT_EQ(measured->comparison().new_hyper_extended_frame_count(), 0);
  measure.clear_reference_clip();
  EXPECT_FALSE(Call(&Stub::MeasureClip, measure)->has_comparison());
  const auto still = CreateStill();
  measure.set_clip(still->name());
  EXPECT_THAT(Call(&Stub::MeasureClip, measure).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "is no body"));
}

TEST_F(MotionCallsTest, BadStepsAreNamedAndMakeNothing) {
  const v1::Clip walk = Walk();
  v1::ProcessClipRequest request = Process(walk);
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "steps: want 1 to 16"));
  request.add_steps()->mutable_low_pass()->set_cutoff_hz(1000);
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "steps[0].low_pass"));
  request.mutable_steps(0)->mutable_resample()->set_frame_time_s(1e-9);
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "steps[0].resample.frame_time"));
  request.mutable_steps(0)->mutable_crop()->set_start_s(9);
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "steps[0].crop"));
  request.mutable_steps(0)->mutable_blend_gait()->set_clip("clips/nobody");
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kNotFound, "clips/nobody"));
  const auto still = CreateStill();
  request.mutable_steps(0)->mutable_blend_gait()->set_clip(still->name());
  EXPECT_THAT(
      Call(&Stub::ProcessClip, request).status(),
      Fails(absl::StatusCode::kFailedPrecondition, "steps[0].blend_gait.clip"));
  v1::ClipLayer* layer =
      request.mutable_steps(0)->mutable_layers()->add_layers();
  layer->set_clip(walk.name());
  layer->mutable_mask()->add_entries()->set_joint_id("tail");
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "steps[0].layers.layers[0].mask.entries[0].joint_id"));
  request.mutable_steps(0)->Clear();
  EXPECT_THAT(Call(&Stub::ProcessClip, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "steps[0]"));
}

TEST_F(MotionCallsTest, RolesAreProposedAndMended) {
  const v1::Clip walk = Walk();
  v1::ProposeJointMapRequest request;
  request.mutable_source()->set_clip(walk.name());
  request.mutable_target()->set_skeleton(walk.skeleton());
  const auto map = Call(&Stub::ProposeJointMap, request);
  ASSERT_TRUE(map.ok()) << map.status();
  const auto joint_of = [](const v1::JointMap& joints, v1::BodyRole role) {
    for (const v1::JointPair& pair : joints.pairs()) {
      if (pair.role() == role) return pair.source_joint_id();
    }
    return std::string();
  };
  EXPECT_EQ(joint_of(*map, v1::BODY_ROLE_LEFT_FOOT), "LeftFoot");
  v1::JointPair* head = request.mutable_overrides()->add_pairs();
  head->set_role(v1::BODY_ROLE_HEAD);
  head->set_source_joint_id("");
  const auto mended = Call(&Stub::ProposeJointMap, request);
  ASSERT_TRUE(mended.ok()) << mended.status();
  EXPECT_EQ(joint_of(*mended, v1::BODY_ROLE_HEAD), "");
  head->set_source_joint_id("tail");
  EXPECT_THAT(Call(&Stub::ProposeJointMap, request).status(),
              Fails(absl::StatusCode::kInvalidArgument,
                    "overrides.pairs[0].source_joint_id: no joint"));
  request.clear_target();
  EXPECT_THAT(Call(&Stub::ProposeJointMap, request).status(),
              Fails(absl::StatusCode::kInvalidArgument, "target"));
}

TEST_F(MotionCallsTest, AWalkMovesAnotherBody) {
  const v1::Clip walk = Walk();
  v1::RetargetClipRequest request;
  request.set_clip(walk.name());
  request.mutable_target()->set_clip(walk.name());
  request.set_display_name("again");
  for (bool live : {false, true}) {
    request.set_without_look_ahead(live);
    const auto made = Call(&Stub::RetargetClip, request);
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_EQ(made->skeleton(), walk.skeleton());
    EXPECT_EQ(made->frame_time_s(), walk.frame_time_s());
    EXPECT_NEAR(made->duration_s(), walk.duration_s(), 1e-9);
    v1::MeasureClipRequest measure;
    measure.set_clip(made->name());
    measure.set_reference_clip(walk.name());
    const auto measured = Call(&Stub::MeasureClip, measure);
    ASSERT_TRUE(measured.ok()) << measured.status();
    EXPECT_LE(measured->comparison().label_skate_ratio(), 0.5);
  }
  request.mutable_target()->set_skeleton("skeletons/planar-arm");
  EXPECT_THAT(Call(&Stub::RetargetClip, request).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "target"));
}

TEST_F(MotionCallsTest, TheBundledHumanoidIsATarget) {
  v1::RetargetClipRequest request;
  request.set_clip(Walk().name());
  request.mutable_target()->set_skeleton("skeletons/humanoid");
  const auto made = Call(&Stub::RetargetClip, request);
  ASSERT_TRUE(made.ok()) << made.status();
  EXPECT_EQ(made->skeleton(), "skeletons/humanoid");
  v1::MeasureClipRequest measure;
  measure.set_clip(made->name());
  measure.set_reference_clip(request.clip());
  const auto measured = Call(&Stub::MeasureClip, measure);
  ASSERT_TRUE(measured.ok()) << measured.status();
  EXPECT_LE(measured->quality().max_penetration_m(), 1e-3);
}

TEST_F(MotionCallsTest, PlaysEveryFrameAsFastAsRead) {
  const v1::Clip walk = Walk(100);
  v1::PlayClipsRequest request = PlayRequest(walk);
  request.set_include_joint_frames(true);
  const Played played = Play(request);
  ASSERT_EQ(played.status, absl::OkStatus());
  ASSERT_EQ(played.frames.size(), 100u);
  EXPECT_LT(played.message_count, 20) << "many in a message";
  EXPECT_NEAR(played.frames[99].time_s(), walk.duration_s(), 1e-9);
  EXPECT_EQ(played.frames[0].joint_frames().world_translations_size(),
            3 * testing::kWalkingJointCount);
  EXPECT_FALSE(played.frames[0].has_report());
}

TEST_F(MotionCallsTest, ALoopPlaysUntilNobodyReads) {
  v1::PlayClipsRequest request = PlayRequest(Walk(20));
  request.mutable_layers(0)->set_loop(true);
  const Played played = Play(request, 500);
  EXPECT_GE(played.frames.size(), 500u);
  EXPECT_EQ(played.status.code(), absl::StatusCode::kCancelled);
}

TEST_F(MotionCallsTest, RealTimeTakesItsTime) {
  v1::PlayClipsRequest request = PlayRequest(Walk(16));
  request.set_pace(v1::PlayClipsRequest::PACE_REAL_TIME);
  const absl::Time begin = absl::Now();
  const Played played = Play(request);
  ASSERT_EQ(played.status, absl::OkStatus());
  // The last frame is due at 0.3 s and is never skipped.
  EXPECT_GE(absl::Now() - begin, absl::Milliseconds(290));
  EXPECT_EQ(played.frames.size() + played.skipped, 16u);
  EXPECT_NEAR(played.frames.back().time_s(), 0.3, 1e-9);
}

TEST_F(MotionCallsTest, GoalsComeOnTopOfClips) {
  const v1::Clip walk = Walk(100);
  v1::PlayClipsRequest request = PlayRequest(walk);
  request.set_include_joint_frames(true);
  const Played plain = Play(request);
  ASSERT_EQ(plain.status, absl::OkStatus());
  // The left hand is on its way to a point beside the first frame's for the
  // first second, and there from then on, relative to nothing but the world.
  v1::GetSkeletonRequest get;
  get.set_name(walk.skeleton());
  const auto skeleton = Call(&v1::KinematicsService::Stub::GetSkeleton, get);
  ASSERT_TRUE(skeleton.ok()) << skeleton.status();
  int hand = -1;
  for (int i = 0; i < skeleton->joints_size(); ++i) {
    if (skeleton->joints(i).joint_id() == "LeftHand") hand = i;
  }
  ASSERT_GE(hand, 0);
  const auto hand_at = [hand](const v1::PlayedFrame& frame, int axis) {
    return frame.joint_frames().world_translations(3 * hand + axis);
  };
  v1::PlayedGoal* goal = request.add_goals();
  goal->mutable_goal()->set_goal_id("hand");
  v1::PositionGoal* position = goal->mutable_goal()->mutable_position();
  position->set_end_effector_id("LeftHand");
  // Only its height counts: 10 cm above where it is in the last frame.
  position->mutable_axes()->set_y(true);
  const double height = hand_at(plain.frames[99], 1) + 0.1;
  position->mutable_world_position()->set_y(height);
  v1::WeightKey* from = goal->mutable_weight()->add_keys();
  from->set_time_s(0.5);
  v1::WeightKey* to = goal->mutable_weight()->add_keys();
  to->set_time_s(1);
  to->set_weight(1);
  const Played played = Play(request);
  ASSERT_EQ(played.status, absl::OkStatus());
  ASSERT_EQ(played.frames.size(), 100u);
  for (int i = 0; i <= 25; ++i) {
    EXPECT_EQ(played.frames[i].pose().SerializeAsString(),
              plain.frames[i].pose().SerializeAsString())
        << "weight 0 is the clip";
  }
  for (int i = 50; i < 100; ++i) {
    EXPECT_NEAR(hand_at(played.frames[i], 1), height, 5e-4) << i;
    EXPECT_EQ(played.frames[i].report().position_errors_m_size(), 1);
  }
}

TEST_F(MotionCallsTest, BadPlaysAreNamed) {
  const v1::Clip walk = Walk(20);
  EXPECT_THAT(Play({}).status,
              Fails(absl::StatusCode::kInvalidArgument, "layers: want 1 to"));
  v1::PlayClipsRequest request = PlayRequest(walk);
  request.set_frame_time_s(-1);
  EXPECT_THAT(Play(request).status,
              Fails(absl::StatusCode::kInvalidArgument, "frame_time_s"));
  request.set_frame_time_s(0);
  request.mutable_layers(0)->mutable_weight()->add_keys()->set_weight(2);
  EXPECT_THAT(Play(request).status,
              Fails(absl::StatusCode::kInvalidArgument, "layers[0].weight"));
  request = PlayRequest(walk);
  request.add_goals();
  EXPECT_THAT(Play(request).status,
              Fails(absl::StatusCode::kInvalidArgument, "goals[0].goal"));
  request = PlayRequest(walk);
  request.add_layers()->set_clip(CreateStill()->name());
  EXPECT_THAT(Play(request).status,
              Fails(absl::StatusCode::kFailedPrecondition, "layers[1].clip"));
}

TEST_F(MotionCallsTest, ARecordedSessionIsAClip) {
  const std::string session = CreateSession();
  v1::StartRecordingRequest start;
  start.set_session(session);
  ASSERT_TRUE(Call(&Stub::StartRecording, start).ok());
  EXPECT_THAT(Call(&Stub::StartRecording, start).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "already"));
  v1::AttachSession attach = testing::AttachRequest(session);
  const auto stream = OpenStream({attach});
  v1::StreamingSolveRequest request;
  for (int i = 1; i <= 10; ++i) {
    v1::TargetFrame frame = testing::WholeFrame(i);
    frame.mutable_capture_time()->set_nanos(20'000'000 * i);
    *request.add_frames() = frame;
  }
  ASSERT_TRUE(stream->Send(request));
  std::vector<v1::PoseFrame> answers;
  while (answers.size() < 10) {
    const auto answer = stream->NextFrame();
    ASSERT_TRUE(answer.has_value());
    answers.push_back(*answer);
  }
  v1::StopRecordingRequest stop;
  stop.set_session(session);
  stop.set_clip_id("recorded");
  stop.set_request_id("stop");
  const auto clip = Call(&Stub::StopRecording, stop);
  ASSERT_TRUE(clip.ok()) << clip.status();
  EXPECT_EQ(clip->name(), "clips/recorded");
  EXPECT_NEAR(clip->frame_time_s(), 0.02, 1e-9);
  const Played played = Play(PlayRequest(*clip));
  ASSERT_EQ(played.frames.size(), 10u);
  for (int i = 0; i < 10; ++i) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(played.frames[i].pose().positions(k),
                  answers[i].pose().positions(k), 1e-9);
    }
  }
  EXPECT_EQ(Call(&Stub::StopRecording, stop)->name(), clip->name());
  stop.set_request_id("");
  EXPECT_THAT(Call(&Stub::StopRecording, stop).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "is not recorded"));
}

TEST_F(MotionCallsTest, ARecordingGoesOnWhereItsClipHasNoPlace) {
  const std::string session = CreateSession();
  v1::StartRecordingRequest start;
  start.set_session(session);
  start.set_max_frame_count(2'000'000'000);
  EXPECT_THAT(Call(&Stub::StartRecording, start).status(),
              Fails(absl::StatusCode::kInvalidArgument, "max_frame_count"));
  start.set_max_frame_count(5);
  ASSERT_TRUE(Call(&Stub::StartRecording, start).ok());
  v1::StopRecordingRequest stop;
  stop.set_session(session);
  EXPECT_THAT(Call(&Stub::StopRecording, stop).status(),
              Fails(absl::StatusCode::kFailedPrecondition, "nothing"));
  v1::SolveSessionRequest solve;
  solve.set_name(session);
  ASSERT_TRUE(Call(&v1::SessionService::Stub::SolveSession, solve).ok());
  const auto clip = Call(&Stub::StopRecording, stop);
  ASSERT_TRUE(clip.ok()) << clip.status();
  EXPECT_EQ(clip->key_count(), 3);
  ASSERT_TRUE(Call(&Stub::StartRecording, start).ok());
  stop.set_discard(true);
  EXPECT_EQ(Call(&Stub::StopRecording, stop)->name(), "");
}

}  // namespace
}  // namespace gelenk
