#include "gelenk/retarget/live_retargeter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "gelenk/retarget/floating_base.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/tracker_goals.h"
#include "tests/testing/allocation_count.h"
#include "tests/testing/body_clips.h"
#include "tests/testing/robot_of_hinges.h"
#include "tests/testing/status_matchers.h"
#include "tests/testing/tracked_actor.h"
#include "tests/testing/walking_bvh.h"

namespace gelenk {
namespace {

using testing::BodyClip;
using testing::Fails;
using ::testing::SizeIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
constexpr int kFrames = 120;

BodyClip Walk() {
  return *testing::BodyClipFromBvh(testing::WalkingBvh(kFrames), "walk");
}

std::shared_ptr<const BodyModel> ModelOf(
    const std::shared_ptr<const Skeleton>& skeleton) {
  return *MakeBodyModel(skeleton, *ProposeJointMap(*skeleton));
}

LiveRetargetSpec WalkOntoHumanoid(const BodyClip& clip) {
  LiveRetargetSpec spec;
  spec.source = clip.model;
  spec.target = ModelOf(MakeHumanoid());
  spec.frame_time_s = clip.frame_time_s;
  return spec;
}

std::unique_ptr<LiveRetargeter> Make(const LiveRetargetSpec& spec) {
  auto live = LiveRetargeter::Create(spec);
  EXPECT_TRUE(live.ok()) << live.status();
  return *std::move(live);
}

void StepTo(const ConstVectorView& pose, std::optional<absl::Duration> time,
            LiveRetargeter& live) {
  live.NoteFrame(time);
  live.Step(pose);
}

// Steps to frame f.
using Feed = std::function<void(LiveRetargeter& live, int f)>;

Eigen::MatrixXd Play(LiveRetargeter& live, const Feed& feed, int first,
                     int last) {
  Eigen::MatrixXd poses(live.positions().size(), last - first);
  for (int f = first; f < last; ++f) {
    feed(live, f);
    poses.col(f - first) = live.positions();
  }
  return poses;
}

TEST(LiveRetargeterTest, IsTheRetargeterFrameByFrame) {
  const BodyClip clip = Walk();
  const LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  const auto live = Make(spec);
  const auto retargeter = Retargeter::Create(spec.source, spec.target);
  ASSERT_TRUE(retargeter.ok());
  for (int f = 0; f < kFrames; ++f) {
    StepTo(clip.positions.col(f), std::nullopt, *live);
    ASSERT_TRUE(
        (*retargeter)->Retarget(clip.positions.col(f), clip.frame_time_s).ok());
    ASSERT_EQ(live->positions(), (*retargeter)->positions()) << f;
  }
}

// What is remembered is all that counts: handed over after any frame, the
// frames after it are the same.
void ExpectExactHandover(const LiveRetargetSpec& spec, const Feed& feed) {
  const auto undisturbed = Make(spec);
  std::vector<std::vector<double>> states;
  Eigen::MatrixXd poses(undisturbed->positions().size(), kFrames);
  for (int f = 0; f < kFrames; ++f) {
    poses.col(f) = Play(*undisturbed, feed, f, f + 1);
    states.push_back(StateOf(*undisturbed));
  }
  for (int last : {0, 1, 2, 9, 30, 31, 55, 80, kFrames - 2}) {
    const auto other = Make(spec);
    // One that was somewhere else before.
    Play(*other, feed, 20, 25);
    const absl::Status status = RestoreState(states[last], *other);
    ASSERT_TRUE(status.ok()) << status;
    other->SetPositions(poses.col(last));
    const Eigen::MatrixXd rest = Play(*other, feed, last + 1, kFrames);
    ASSERT_EQ(rest, poses.rightCols(kFrames - last - 1)) << last;
  }
}

Feed PosesOf(const BodyClip& clip) {
  return [&clip](LiveRetargeter& live, int f) {
    StepTo(clip.positions.col(f), absl::Milliseconds(20) * f, live);
  };
}

TEST(LiveRetargeterTest, StateGoesOverToABodyWithLimits) {
  const BodyClip clip = Walk();
  ExpectExactHandover(WalkOntoHumanoid(clip), PosesOf(clip));
}

TEST(LiveRetargeterTest, StateGoesOverToARobot) {
  const BodyClip clip = Walk();
  LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  spec.target = ModelOf(*WithFloatingBase(testing::RobotOfHinges()));
  ExpectExactHandover(spec, PosesOf(clip));
}

TEST(LiveRetargeterTest, StateGoesOverWithTrackers) {
  const testing::Actor actor = testing::WalkingActor(kFrames);
  LiveRetargetSpec spec;
  spec.trackers.emplace();
  spec.target = ModelOf(MakeHumanoid(1.5));
  for (bool with_lower : {false, true}) {
    ExpectExactHandover(spec, [&](LiveRetargeter& live, int f) {
      TrackerFrame frame =
          testing::TrackersOn(*actor.model, actor.positions.col(f), with_lower);
      if (f % 40 > 30) frame.hands[kLeft].reset();
      live.NoteFrame(absl::Milliseconds(20) * f);
      live.Step(frame);
    });
  }
}

TEST(LiveRetargeterTest, StateIsSmall) {
  const BodyClip clip = Walk();
  const auto live = Make(WalkOntoHumanoid(clip));
  for (int f = 0; f < kFrames; ++f) {
    StepTo(clip.positions.col(f), std::nullopt, *live);
    // Of the feet's past a thirtieth of a second, not all that is kept.
    ASSERT_LE(StateOf(*live).size(), 200u);
  }
}

TEST(LiveRetargeterTest, NumbersThatAreNoStateChangeNothing) {
  const BodyClip clip = Walk();
  const LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  const auto live = Make(spec);
  Play(*live, PosesOf(clip), 0, 30);
  const std::vector<double> state = StateOf(*live);
  const auto refuse = [&](std::vector<double> numbers, const char* names) {
    EXPECT_THAT(RestoreState(numbers, *live), Fails(kInvalid, names));
    EXPECT_EQ(StateOf(*live), state);
  };
  for (size_t i = 0; i < state.size(); ++i) {
    std::vector<double> bad = state;
    bad[i] = std::numeric_limits<double>::quiet_NaN();
    refuse(bad, "state[");
    bad[i] = 1e300;
    refuse(bad, "state[");
    refuse({state.begin(), state.begin() + static_cast<int>(i)}, "state");
  }
  std::vector<double> longer = state;
  longer.push_back(0);
  refuse(longer, "state: want");
}

TEST(LiveRetargeterTest, TimeIsThatBetweenCaptures) {
  const BodyClip clip = Walk();
  LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  // Counts for the first frame, and where no captures are told.
  spec.frame_time_s = 0.04;
  const auto play = [&](std::optional<absl::Duration> spacing) {
    const auto live = Make(spec);
    const Feed feed = [&](LiveRetargeter& live, int f) {
      std::optional<absl::Duration> time;
      if (spacing) time = absl::Seconds(1.7e9) + *spacing * f;
      StepTo(clip.positions.col(f), time, live);
    };
    return Play(*live, feed, 0, kFrames);
  };
  EXPECT_EQ(play(absl::Milliseconds(40)), play(std::nullopt));
  EXPECT_NE(play(absl::Milliseconds(20)), play(std::nullopt));
}

TEST(LiveRetargeterTest, MergedFramesTakeTheirTime) {
  const BodyClip clip = Walk();
  const LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  const auto merged = Make(spec);
  LiveRetargetSpec slow = spec;
  slow.frame_time_s *= 2;
  const auto halved = Make(slow);
  for (int f = 0; f + 1 < kFrames; f += 2) {
    merged->NoteFrame(std::nullopt);
    StepTo(clip.positions.col(f + 1), std::nullopt, *merged);
    StepTo(clip.positions.col(f + 1), std::nullopt, *halved);
    ASSERT_EQ(merged->positions(), halved->positions()) << f;
  }
}

TEST(LiveRetargeterTest, TimeThatStandsOrRunsBackIsRefused) {
  const BodyClip clip = Walk();
  const auto live = Make(WalkOntoHumanoid(clip));
  StepTo(clip.positions.col(0), absl::Seconds(5), *live);
  EXPECT_TRUE(live->CheckTime(std::nullopt).ok());
  EXPECT_TRUE(live->CheckTime(absl::Seconds(5.01)).ok());
  for (double seconds : {5.0, 4.0}) {
    EXPECT_THAT(live->CheckTime(absl::Seconds(seconds)),
                Fails(kInvalid, "capture_time: want after 5s"));
  }
  live->ForgetTime();
  EXPECT_TRUE(live->CheckTime(absl::Seconds(1)).ok());
}

TEST(LiveRetargeterTest, AfterALongPauseTheMotionBeginsAnew) {
  const BodyClip clip = Walk();
  const auto live = Make(WalkOntoHumanoid(clip));
  Play(*live, PosesOf(clip), 0, 50);
  StepTo(clip.positions.col(0), absl::Minutes(5), *live);
  const auto fresh = Make(live->spec());
  StepTo(clip.positions.col(0), std::nullopt, *fresh);
  EXPECT_EQ(live->positions(), fresh->positions());
}

TEST(LiveRetargeterTest, TheRootGoesAsFarAsItIsTold) {
  const BodyClip clip = Walk();
  LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  const auto way_of = [&](std::optional<double> scale) {
    spec.options.root_scale = scale;
    const auto live = Make(spec);
    const Eigen::MatrixXd poses = Play(*live, PosesOf(clip), 0, kFrames);
    return (poses.col(kFrames - 1) - poses.col(0)).head<3>().eval();
  };
  const double source_way =
      (clip.positions.col(kFrames - 1) - clip.positions.col(0))
          .head<3>()
          .norm();
  EXPECT_NEAR(way_of(2).norm(), 2 * source_way, 0.1 * source_way);
  EXPECT_NEAR(way_of(0.5).norm(), 0.5 * source_way, 0.1 * source_way);
}

TEST(LiveRetargeterTest, BadSpecsAreNamed) {
  const BodyClip clip = Walk();
  LiveRetargetSpec spec = WalkOntoHumanoid(clip);
  spec.frame_time_s = 0;
  spec.options.root_scale = -1;
  const absl::Status status = LiveRetargeter::Create(spec).status();
  EXPECT_THAT(status, Fails(kInvalid, "frame_time_s"));
  EXPECT_THAT(status, Fails(kInvalid, "options.root_scale"));
  spec = WalkOntoHumanoid(clip);
  spec.trackers.emplace().height_m = 9;
  EXPECT_THAT(LiveRetargeter::Create(spec).status(),
              Fails(kInvalid, "trackers"));
}

TEST(LiveRetargeterTest, WarmFramesAllocateNothing) {
  const BodyClip clip = Walk();
  const auto live = Make(WalkOntoHumanoid(clip));
  const Feed feed = PosesOf(clip);
  Play(*live, feed, 0, 60);
  const int before = testing::AllocationCount();
  for (int f = 60; f < kFrames; ++f) {
    StepTo(clip.positions.col(f), absl::Milliseconds(20) * f, *live);
  }
  EXPECT_EQ(testing::AllocationCount(), before);
}

Goal TrackerGoal(std::string id, const RigidTransform& place,
                 double weight = 1) {
  PoseGoal pose;
  pose.end_effector_id = "head";
  pose.world_pose = place;
  Goal goal;
  goal.id = std::move(id);
  goal.weight = weight;
  goal.kind = std::move(pose);
  return goal;
}

TEST(TrackerGoalsTest, AreTrackersByTheirNames) {
  std::vector<Goal> goals;
  for (size_t i = 0; i < kTrackerIds.size(); ++i) {
    RigidTransform place;
    place.translation.x() = static_cast<double>(i);
    goals.push_back(TrackerGoal(std::string(kTrackerIds[i]), place));
  }
  goals[4].weight = 0;
  EXPECT_TRUE(CheckTrackerGoals(goals).ok());
  RigidTransform canonical_from_world;
  canonical_from_world.translation.y() = 1;
  const TrackerFrame frame = TrackersOf(goals, canonical_from_world);
  EXPECT_EQ(frame.head->translation, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(frame.hands[kLeft]->translation, Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(frame.hands[kRight]->translation, Eigen::Vector3d(2, 1, 0));
  EXPECT_EQ(frame.waist->translation, Eigen::Vector3d(3, 1, 0));
  EXPECT_FALSE(frame.feet[kLeft].has_value());
  EXPECT_EQ(frame.feet[kRight]->translation, Eigen::Vector3d(5, 1, 0));
}

TEST(TrackerGoalsTest, OthersAreRefused) {
  std::vector<Goal> goals = {TrackerGoal("tail", {}), TrackerGoal("waist", {})};
  goals[1].kind = PositionGoal();
  const absl::Status status = CheckTrackerGoals(goals);
  EXPECT_THAT(status, Fails(kInvalid, "goals[0].goal_id"));
  EXPECT_THAT(status, Fails(kInvalid, "\"tail\""));
  EXPECT_THAT(status, Fails(kInvalid, "goals[1]"));
  EXPECT_THAT(status, Fails(kInvalid, "want the tracker \"head\""));
}

}  // namespace
}  // namespace gelenk
