#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "client/cli/file_bytes.h"
#include "client/cli/play/clip_goals.h"
#include "client/cli/play/limit_choice.h"
#include "client/cli/play/play_report.h"
#include "client/cli/play/residuals.h"
#include "client/cli/play/summary.h"
#include "client/cli/play/target_frame.h"
#include "convert/skeleton.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/client/cli/sample_playback.h"

namespace gelenk::cli {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> IdsOf(const std::vector<Goal>& goals) {
  std::vector<std::string> ids;
  for (const Goal& goal : goals) ids.emplace_back(EffectorId(goal.kind));
  return ids;
}

TEST(ClipGoalsTest, ABodyGetsItsPartsAsGoals) {
  const Playback playback = SamplePlayback(1);
  EXPECT_THAT(IdsOf(playback.goals),
              ElementsAre("Hips", "LeftHand", "RightHand", "LeftFoot",
                          "RightFoot", "Head"));
  EXPECT_TRUE(std::holds_alternative<PoseGoal>(playback.goals[0].kind));
  EXPECT_TRUE(std::holds_alternative<PositionGoal>(playback.goals[1].kind));
}

TEST(ClipGoalsTest, WhatIsNoBodyGetsItsEnds) {
  Joint root;
  root.id = "root";
  root.type = JointType::kFree;
  Joint arm;
  arm.id = "arm";
  arm.parent_id = "root";
  arm.type = JointType::kSpherical;
  Joint bare = arm;
  bare.id = "bare";
  EndEffector tip;
  tip.id = "tip";
  tip.joint_id = "arm";
  const auto skeleton = *SkeletonBuilder()
                             .AddJoint(root)
                             .AddJoint(arm)
                             .AddJoint(bare)
                             .AddEndEffector(tip)
                             .Build();
  EXPECT_THAT(IdsOf(GoalsFor(*skeleton, FindBodyParts(*skeleton))),
              ElementsAre("root", "tip", "bare"));
}

TEST(ClipGoalsTest, ThePoseThatGaveTheTargetsHasNoError) {
  const Playback playback = SamplePlayback(3);
  WorldTransforms frames;
  std::vector<GoalTarget> targets;
  ForwardKinematics(*playback.skeleton, playback.clip_poses.col(2), frames);
  TargetsAt(*playback.skeleton, playback.goals, frames, targets);
  for (size_t i = 0; i < targets.size(); ++i) {
    EXPECT_TRUE(Fits(playback.goals[i].kind, targets[i]));
    const GoalError error =
        ErrorOf(*playback.skeleton, playback.goals[i], targets[i], frames);
    EXPECT_EQ(error.position_m, 0);
    EXPECT_NEAR(error.rotation_rad, 0, 1e-15);
  }
}

TEST(TargetFrameTest, SaysEveryGoalByItsIndex) {
  const Playback playback = SamplePlayback(60);
  const v1::TargetFrame frame = TargetFrameWriter(playback).Write(55);
  EXPECT_EQ(frame.sequence_number(), 56);
  EXPECT_EQ(frame.capture_time().seconds(), 1);
  EXPECT_NEAR(frame.capture_time().nanos(), 100'000'000, 1);
  ASSERT_EQ(frame.targets_size(), 6);
  EXPECT_TRUE(frame.targets(0).has_world_pose());
  for (int i = 1; i < 6; ++i) {
    EXPECT_EQ(frame.targets(i).goal_index(), i);
    EXPECT_TRUE(frame.targets(i).has_world_position());
  }
}

TEST(TargetFrameTest, TakesAnswersWhereTheyBelong) {
  Playback playback = SamplePlayback(3);
  playback.answers.assign(3, Answer());
  v1::PoseFrame message;
  message.set_sequence_number(2);
  const Eigen::VectorXd pose = playback.clip_poses.col(0);
  message.mutable_pose()->mutable_positions()->Assign(
      pose.data(), pose.data() + pose.size());
  message.mutable_report()->set_outcome(
      v1::SolveReport::OUTCOME_STALLED_AT_LIMITS);
  message.mutable_report()->add_position_errors_m(0.5f);
  message.mutable_report()->mutable_solve_duration()->set_nanos(7000);
  message.set_merged_frame_count(1);
  ASSERT_TRUE(TakeAnswer(message, &playback).ok());
  EXPECT_FALSE(playback.answers[0].answered);
  const Answer& answer = playback.answers[1];
  EXPECT_TRUE(answer.answered);
  EXPECT_EQ(answer.outcome, SolveOutcome::kStalledAtLimits);
  EXPECT_THAT(answer.position_errors_m, ElementsAre(0.5));
  EXPECT_EQ(answer.merged_frame_count, 1);
  EXPECT_EQ(answer.solve_duration, absl::Microseconds(7));
  EXPECT_EQ(playback.answered_poses.col(1), pose);
}

TEST(TargetFrameTest, KeepsWhyAFrameWasRefused) {
  Playback playback = SamplePlayback(2);
  playback.answers.assign(2, Answer());
  v1::PoseFrame message;
  message.set_sequence_number(1);
  message.mutable_status()->set_code(3);
  message.mutable_status()->set_message("targets[0]: not finite");
  ASSERT_TRUE(TakeAnswer(message, &playback).ok());
  EXPECT_FALSE(playback.answers[0].answered);
  EXPECT_EQ(playback.answers[0].error, "targets[0]: not finite");
}

TEST(TargetFrameTest, RefusesPosesOfAnotherSkeleton) {
  Playback playback = SamplePlayback(2);
  v1::PoseFrame message;
  message.set_sequence_number(1);
  message.mutable_pose()->add_positions(0);
  EXPECT_EQ(TakeAnswer(message, &playback).code(), absl::StatusCode::kInternal);
}

TEST(ResidualsTest, MeasureWhatTheAnswersMiss) {
  Playback playback = SamplePlayback(4);
  // The root's first number is its x: everything is 2 mm off.
  playback.answered_poses(0, 2) += 2e-3;
  const Residuals residuals = MeasureResiduals(playback);
  EXPECT_NEAR(residuals.position_m[1], 0, 1e-12);
  EXPECT_NEAR(residuals.position_m[2], 2e-3, 1e-12);
  EXPECT_NEAR(residuals.disagreement_m, 2e-3, 1e-12);
  EXPECT_EQ(residuals.limit_excess, 0);
}

TEST(ResidualsTest, FramesWithoutAnAnswerDoNotCount) {
  Playback playback = SamplePlayback(4);
  playback.answered_poses(0, 2) += 2e-3;
  playback.answers[2].answered = false;
  EXPECT_NEAR(MeasureResiduals(playback).position_m[2], 0, 1e-12);
}

TEST(ResidualsTest, NameTheJointThatBreaksItsLimits) {
  const BvhClip clip = SampleClip(50);
  Playback playback = SamplePlayback(50);
  playback.skeleton = ChooseLimits(clip, kClipLimits)->skeleton;
  EXPECT_LT(MeasureResiduals(playback).limit_excess, 1e-12);

  const int knee = playback.skeleton->FindJoint("LeftLeg");
  const int row = playback.skeleton->span(knee).position_offset;
  const double angle = 90 * std::numbers::pi / 180;
  playback.answered_poses.block<4, 1>(row, 7) << std::sin(angle / 2), 0, 0,
      std::cos(angle / 2);
  const Residuals residuals = MeasureResiduals(playback);
  EXPECT_EQ(residuals.limit_joint_id, "LeftLeg");
  EXPECT_GT(residuals.limit_excess, 0.5);
}

TEST(LimitChoiceTest, NoneLeavesTheSkeletonAsItIs) {
  const BvhClip clip = SampleClip(5);
  EXPECT_EQ(ChooseLimits(clip, kNoLimits)->skeleton, clip.import.skeleton);
}

TEST(LimitChoiceTest, OfTheClipHoldEveryFrame) {
  const BvhClip clip = SampleClip(60);
  const auto limited = ChooseLimits(clip, kClipLimits);
  ASSERT_TRUE(limited.ok()) << limited.status();
  EXPECT_THAT(limited->description, HasSubstr("± 5°"));
  for (int frame = 0; frame < clip.frame_count(); ++frame) {
    EXPECT_LT(LimitExcess(*limited->skeleton, clip.poses.col(frame), nullptr),
              1e-12);
  }
}

TEST(LimitChoiceTest, OfAFileAreTakenByJoint) {
  const BvhClip clip = SampleClip(5);
  Joint hips;
  hips.id = "Hips";
  hips.type = JointType::kFree;
  Joint head;
  head.id = "Head";
  head.parent_id = "Hips";
  head.type = JointType::kSpherical;
  head.axis = Eigen::Vector3d::UnitY();
  head.limits.swing_cone_rad = 0.25;
  v1::Skeleton message;
  convert::ToProto(**SkeletonBuilder().AddJoint(hips).AddJoint(head).Build(),
                   &message);
  const std::string path =
      (std::filesystem::path(::testing::TempDir()) / "head.json").string();
  ASSERT_TRUE(WriteFile(path, convert::SkeletonToJson(message)).ok());

  const auto limited = ChooseLimits(clip, path);
  ASSERT_TRUE(limited.ok()) << limited.status();
  const Skeleton& skeleton = *limited->skeleton;
  const Joint& limited_head = skeleton.joint(skeleton.FindJoint("Head"));
  EXPECT_EQ(limited_head.limits.swing_cone_rad, 0.25);
  EXPECT_EQ(limited_head.axis, Eigen::Vector3d::UnitY());
  EXPECT_EQ(limited->description, "of head.json for 2 of 17 joints");
}

TEST(SummaryTest, QuantilesAreValuesThatOccur) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Quantiles quantiles = QuantilesOf(values);
  EXPECT_EQ(quantiles.p50, 50);
  EXPECT_EQ(quantiles.p99, 99);
  EXPECT_EQ(quantiles.max, 100);
  EXPECT_EQ(QuantilesOf({3}).p50, 3);
  EXPECT_EQ(QuantilesOf({}).max, 0);
}

TEST(SummaryTest, CountsOutcomesOfAnswersOnly) {
  Playback playback = SamplePlayback(5);
  playback.answers[1].outcome = SolveOutcome::kUnreachable;
  playback.answers[2].answered = false;
  playback.answers[3].merged_frame_count = 1;
  const Summary summary = Summarize(playback, MeasureResiduals(playback));
  EXPECT_EQ(summary.frame_count, 5);
  EXPECT_EQ(summary.answered_count, 4);
  EXPECT_EQ(summary.converged_count, 3);
  EXPECT_EQ(summary.unreachable_count, 1);
  EXPECT_EQ(summary.converged_share, 0.75);
  EXPECT_EQ(summary.merged_count, 1);
  EXPECT_DOUBLE_EQ(summary.clip_fps, 50);
  EXPECT_DOUBLE_EQ(summary.clip_duration_s, 0.1);
  EXPECT_DOUBLE_EQ(summary.played_fps, 800);
  EXPECT_EQ(summary.solve_us.p50, 10);
}

class PlayReportTest : public ::testing::Test {
 protected:
  PlayReport Report() {
    residuals_ = MeasureResiduals(playback_);
    PlayReport report;
    report.playback = &playback_;
    report.residuals = &residuals_;
    report.limits = &limits_;
    report.summary = Summarize(playback_, residuals_);
    report.unit_m = 0.01;
    return report;
  }

  Playback playback_ = SamplePlayback(8);
  Residuals residuals_;
  LimitedSkeleton limits_ = {playback_.skeleton, "none", {"a note"}};
};

TEST_F(PlayReportTest, TellsOutcomesAndResiduals) {
  playback_.answers[0].outcome = SolveOutcome::kIterationLimit;
  PlayReport report = Report();
  report.written = {"out.bvh"};
  const std::string text = PlayReportText(report);
  EXPECT_THAT(text,
              AllOf(HasSubstr("walk.bvh, 8 frames"),
                    HasSubstr("87.50 % converged (7 of 8)"),
                    HasSubstr("1 at the iteration limit"),
                    HasSubstr("every answer inside"), HasSubstr("a note"),
                    HasSubstr("out.bvh"), HasSubstr("position residual (mm)")));
  EXPECT_THAT(text, Not(HasSubstr("other residuals")));
  EXPECT_TRUE(CheckPlayed(report).ok());
}

TEST_F(PlayReportTest, JsonHasItsKeys) {
  const Json json = PlayReportJson(Report());
  EXPECT_EQ(json["clip"], "walk.bvh");
  EXPECT_EQ(json["answered"], 8);
  EXPECT_EQ(json["outcomes"]["converged"], 8);
  EXPECT_EQ(json["converged_share"], 1.0);
  EXPECT_EQ(json["limits_kept"], true);
  EXPECT_EQ(json["goals"].size(), 6u);
  EXPECT_TRUE(json["first_frame_jump"].is_null());
  for (const char* key : {"position_residual_mm", "rotation_residual_mrad",
                          "solve_us", "round_trip_us"}) {
    EXPECT_TRUE(json[key].contains("p50")) << key;
    EXPECT_TRUE(json[key].contains("p99")) << key;
    EXPECT_TRUE(json[key].contains("max")) << key;
  }
}

TEST_F(PlayReportTest, ADisagreementIsShownAndIsAnError) {
  playback_.answered_poses(0, 3) += 5e-3;
  const PlayReport report = Report();
  EXPECT_THAT(PlayReportText(report), HasSubstr("other residuals"));
  EXPECT_FALSE(CheckPlayed(report).ok());
}

TEST_F(PlayReportTest, RefusedFramesAreAnError) {
  playback_.answers[3] = Answer();
  playback_.answers[3].error = "targets[1]: not finite";
  EXPECT_EQ(std::string(CheckPlayed(Report()).message()),
            "1 frames were refused, the first: frame 3: targets[1]: not "
            "finite");
}

}  // namespace
}  // namespace gelenk::cli
