// Frames with a fault: each is refused in its own answer, which names field and
// value, and nothing else happens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "tests/integration/service_test.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::kAimGoal;
using ::testing::SizeIs;
using testing::SolveStream;
using testing::WholeFrame;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kInvalidArgument = 3;

using Positions = std::vector<double>;

Positions PositionsOf(const v1::PoseFrame& frame) {
  return {frame.pose().positions().begin(), frame.pose().positions().end()};
}

// How a good frame becomes a bad one, and what its answer says.
struct Fault {
  std::string name;
  std::function<void(v1::TargetFrame&)> commit;
  std::vector<std::string> told;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

v1::Vector3* ReachTarget(v1::TargetFrame& frame) {
  return frame.mutable_targets(0)->mutable_world_position();
}

v1::Quaternion* AimTarget(v1::TargetFrame& frame) {
  return frame.mutable_targets(1)->mutable_world_rotation();
}

std::vector<Fault> Faults() {
  using Frame = v1::TargetFrame;
  return {
      {"Nan",
       [](Frame& frame) { ReachTarget(frame)->set_y(kNan); },
       {"targets[0].world_position: ", "nan"}},
      {"Infinity",
       [](Frame& frame) { ReachTarget(frame)->set_z(-kInfinity); },
       {"targets[0].world_position: ", "-inf"}},
      {"GoalIndexTooLarge",
       [](Frame& frame) { frame.mutable_targets(1)->set_goal_index(2); },
       {"targets[1].goal_index: want 0 to 1, got 2"}},
      {"GoalIndexNegative",
       [](Frame& frame) { frame.mutable_targets(0)->set_goal_index(-1); },
       {"targets[0].goal_index: want 0 to 1, got -1"}},
      {"PositionForARotation",
       [](Frame& frame) {
         frame.mutable_targets(1)->mutable_world_position()->set_x(1);
       },
       {"targets[1].target: ", "rotation goal \"aim\""}},
      {"PoseForAPosition",
       [](Frame& frame) { frame.mutable_targets(0)->mutable_world_pose(); },
       {"targets[0].target: ", "position goal \"reach\""}},
      {"NoTarget",
       [](Frame& frame) { frame.mutable_targets(0)->clear_target(); },
       {"targets[0].target: is not set"}},
      {"QuaternionOfZeros",
       [](Frame& frame) { AimTarget(frame)->Clear(); },
       {"targets[1].world_rotation: "}},
      {"QuaternionOffUnit",
       [](Frame& frame) {
         AimTarget(frame)->set_z(0);
         AimTarget(frame)->set_w(1.002);
       },
       {"targets[1].world_rotation: ", "1.002"}},
      {"QuaternionNan",
       [](Frame& frame) { AimTarget(frame)->set_x(kNan); },
       {"targets[1].world_rotation: "}},
      {"WeightNegative",
       [](Frame& frame) { frame.mutable_targets(0)->set_weight(-0.5); },
       {"targets[0].weight: ", "-0.5"}},
      {"WeightNan",
       [](Frame& frame) { frame.mutable_targets(1)->set_weight(kNan); },
       {"targets[1].weight: ", "nan"}},
      {"PlaceNan",
       [](Frame& frame) {
         frame.mutable_world_from_skeleton()->mutable_translation()->set_x(
             kNan);
       },
       {"world_from_skeleton.translation: ", "nan"}},
      {"PlaceOffUnit",
       [](Frame& frame) {
         frame.mutable_world_from_skeleton()->mutable_rotation()->set_w(2);
       },
       {"world_from_skeleton.rotation: ", "2"}},
      {"RemovesAGoalThatIsNotThere",
       [](Frame& frame) {
         frame.mutable_goal_patch()->add_removed_goal_ids("nose");
       },
       {"goal_patch.removed_goal_ids[0]: ", "\"nose\""}},
      {"AddsAGoalWithoutKind",
       [](Frame& frame) {
         frame.mutable_goal_patch()->add_goals()->set_goal_id("empty");
       },
       {"goal_patch.goals[0]"}},
      {"AddsAGoalAtAnEffectorThatIsNotThere",
       [](Frame& frame) {
         v1::Goal* goal = frame.mutable_goal_patch()->add_goals();
         goal->set_goal_id("sniff");
         goal->mutable_position()->set_end_effector_id("nose");
       },
       {"end_effector_id", "\"nose\""}},
      {"SequenceNumberRepeated",
       [](Frame& frame) { frame.set_sequence_number(10); },
       {"sequence_number: want more than 10, got 10"}},
      {"SequenceNumberOld",
       [](Frame& frame) { frame.set_sequence_number(-3); },
       {"sequence_number: want more than 10, got -3"}},
      {"TwoFaults",
       [](Frame& frame) {
         ReachTarget(frame)->set_x(kNan);
         AimTarget(frame)->set_w(7);
       },
       {"targets[0].world_position: ", "targets[1].world_rotation: "}},
  };
}

class BadFrameTest : public ServiceTest,
                     public ::testing::WithParamInterface<Fault> {
 protected:
  static std::unique_ptr<SolveStream> OpenOne(v1::FramePolicy policy) {
    v1::AttachSession attach = AttachRequest(CreateSession());
    attach.set_frame_policy(policy);
    return OpenStream({attach});
  }

  static v1::TargetFrame BadFrame(int64_t sequence_number) {
    v1::TargetFrame frame = WholeFrame(sequence_number);
    frame.mutable_capture_time()->set_seconds(9);
    GetParam().commit(frame);
    return frame;
  }

  static void ExpectRefused(const v1::PoseFrame& answer) {
    EXPECT_EQ(answer.status().code(), kInvalidArgument);
    for (const std::string& words : GetParam().told) {
      EXPECT_THAT(answer.status().message(), HasSubstr(words));
    }
    EXPECT_EQ(answer.capture_time().seconds(), 9);
    EXPECT_FALSE(answer.has_report());
  }
};

TEST_P(BadFrameTest, IsRefusedAndChangesNothing) {
  const auto disturbed = OpenOne(v1::FRAME_POLICY_EVERY_FRAME);
  const auto undisturbed = OpenOne(v1::FRAME_POLICY_EVERY_FRAME);
  for (SolveStream* stream : {disturbed.get(), undisturbed.get()}) {
    ASSERT_TRUE(stream->SendFrame(WholeFrame(10)));
    const auto answer = stream->NextFrame();
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->status().code(), 0);
  }
  ASSERT_TRUE(disturbed->SendFrame(BadFrame(15)));
  const auto refusal = disturbed->NextFrame();
  ASSERT_TRUE(refusal);
  ExpectRefused(*refusal);

  // Not even a goal that was right beside the wrong one was taken: a frame that
  // names no goal solves for what there was.
  for (int i : {16, 17}) {
    v1::TargetFrame frame = WholeFrame(i);
    if (i == 16) frame.clear_targets();
    std::vector<Positions> positions;
    for (SolveStream* stream : {disturbed.get(), undisturbed.get()}) {
      ASSERT_TRUE(stream->SendFrame(frame));
      const auto answer = stream->NextFrame();
      ASSERT_TRUE(answer);
      EXPECT_EQ(answer->status().code(), 0) << answer->status().message();
      EXPECT_EQ(answer->sequence_number(), i);
      positions.push_back(PositionsOf(*answer));
    }
    EXPECT_EQ(positions[0], positions[1]);
    // Solving for the same again moves nothing that counts.
    if (i == 16) {
      for (size_t j = 0; j < positions[0].size(); ++j) {
        EXPECT_NEAR(PositionsOf(*refusal)[j], positions[0][j], 1e-3);
      }
    }
  }
}

// Between good ones of one message: in order, with the pose before it.
TEST_P(BadFrameTest, StandsInItsPlaceAmongGoodOnes) {
  for (v1::FramePolicy policy :
       {v1::FRAME_POLICY_EVERY_FRAME, v1::FRAME_POLICY_LATEST_WINS}) {
    const auto stream = OpenOne(policy);
    v1::StreamingSolveRequest request;
    *request.add_frames() = WholeFrame(9);
    *request.add_frames() = WholeFrame(10);
    *request.add_frames() = BadFrame(11);
    *request.add_frames() = WholeFrame(12);
    *request.add_frames() = WholeFrame(13);
    ASSERT_TRUE(stream->Send(request));
    std::vector<v1::PoseFrame> answers;
    while (answers.empty() || answers.back().sequence_number() != 13) {
      const auto answer = stream->NextFrame();
      ASSERT_TRUE(answer);
      answers.push_back(*answer);
    }
    const bool every = policy == v1::FRAME_POLICY_EVERY_FRAME;
    ASSERT_THAT(answers, SizeIs(every ? 5 : 3));
    const size_t bad = every ? 2 : 1;
    ExpectRefused(answers[bad]);
    EXPECT_EQ(answers[bad].sequence_number(), BadFrame(11).sequence_number());
    EXPECT_EQ(answers[bad - 1].sequence_number(), 10);
    EXPECT_EQ(PositionsOf(answers[bad]), PositionsOf(answers[bad - 1]));
    for (size_t i = 0; i < answers.size(); ++i) {
      if (i == bad) continue;
      EXPECT_EQ(answers[i].status().code(), 0) << answers[i].status().message();
      EXPECT_EQ(answers[i].merged_frame_count(), every ? 0 : 1);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Faults, BadFrameTest, ::testing::ValuesIn(Faults()),
                         [](const auto& info) { return info.param.name; });

class BadFramesTest : public ServiceTest {};

TEST_F(BadFramesTest, UseUpTheirNumbers) {
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  v1::TargetFrame bad = WholeFrame(5);
  ReachTarget(bad)->set_x(kNan);
  ASSERT_TRUE(stream->SendFrame(bad));
  ASSERT_TRUE(stream->SendFrame(WholeFrame(5)));
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(2);
  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_THAT(answers[1].status().message(),
              HasSubstr("sequence_number: want more than 5, got 5"));
}

TEST_F(BadFramesTest, OfASlotThatIsNotThereHurtNoOther) {
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  v1::StreamingSolveRequest request;
  *request.add_frames() = WholeFrame(1, 0);
  *request.add_frames() = WholeFrame(1, 1);
  *request.add_frames() = WholeFrame(2, -1);
  *request.add_frames() = WholeFrame(2, 0);
  ASSERT_TRUE(stream->Send(request));
  std::vector<int> codes;
  for (const v1::PoseFrame& answer : stream->NextFrames(4)) {
    codes.push_back(answer.status().code());
    EXPECT_EQ(answer.has_pose(), answer.slot() == 0);
  }
  EXPECT_THAT(codes, ElementsAre(0, kInvalidArgument, kInvalidArgument, 0));
}

TEST_F(BadFramesTest, BeforeAnyAttachAreAnswered) {
  const auto stream = OpenStream();
  ASSERT_TRUE(stream->SendFrame(WholeFrame(1)));
  const auto answer = stream->NextFrame();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status().code(), kInvalidArgument);
  EXPECT_THAT(answer->status().message(), HasSubstr("slot 0"));
}

// One NaN from a tracker must not end a show, nor must many.
TEST_F(BadFramesTest, EveryOtherOneForAWhile) {
  const auto stream = OpenStream({AttachRequest(CreateSession())});
  constexpr int kFrames = 1000;
  v1::StreamingSolveRequest request;
  for (int i = 1; i <= kFrames; ++i) {
    v1::TargetFrame* frame = request.add_frames();
    *frame = WholeFrame(i);
    if (i % 2 == 0) AimTarget(*frame)->set_w(kNan);
  }
  ASSERT_TRUE(stream->Send(request));
  const std::vector<v1::PoseFrame> answers = stream->NextFrames(kFrames);
  ASSERT_THAT(answers, SizeIs(kFrames));
  for (int i = 1; i <= kFrames; ++i) {
    ASSERT_EQ(answers[i - 1].sequence_number(), i);
    ASSERT_EQ(answers[i - 1].status().code(),
              i % 2 == 0 ? kInvalidArgument : 0);
  }
}

}  // namespace
}  // namespace gelenk
