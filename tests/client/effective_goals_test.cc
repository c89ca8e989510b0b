// Against the server's way of keeping goals: convert::Merge and core goals.
#include "gelenk/client/effective_goals.h"

#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/goal.h"

namespace gelenk::client {
namespace {

using google::protobuf::util::MessageDifferencer;
using Random = std::mt19937_64;

double Number(Random& random) {
  return std::uniform_real_distribution<double>(-1, 1)(random);
}

int Index(Random& random, int count) {
  return std::uniform_int_distribution<int>(0, count - 1)(random);
}

void SetUnitRotation(Random& random, v1::Quaternion* rotation) {
  const double half = Number(random);
  rotation->set_y(std::sin(half));
  rotation->set_w(std::cos(half));
}

v1::Goal RandomGoal(Random& random, const std::string& id) {
  v1::Goal goal;
  goal.set_goal_id(id);
  if (Index(random, 2) == 0) goal.set_weight(1 + Number(random));
  switch (Index(random, 3)) {
    case 0:
      goal.mutable_position()->set_end_effector_id("hand");
      goal.mutable_position()->mutable_world_position()->set_x(Number(random));
      break;
    case 1:
      goal.mutable_rotation()->set_end_effector_id("hand");
      if (Index(random, 2) == 0) break;  // identity
      SetUnitRotation(random,
                      goal.mutable_rotation()->mutable_world_rotation());
      break;
    default:
      goal.mutable_pose()->set_end_effector_id("hand");
      goal.mutable_pose()->mutable_axes()->set_y(true);
      SetUnitRotation(
          random,
          goal.mutable_pose()->mutable_world_pose()->mutable_rotation());
  }
  return goal;
}

void SetRandomTarget(Random& random, const v1::Goal& goal,
                     v1::GoalTarget* target) {
  if (goal.has_position()) {
    target->mutable_world_position()->set_z(Number(random));
  } else if (goal.has_rotation()) {
    SetUnitRotation(random, target->mutable_world_rotation());
  } else {
    target->mutable_world_pose()->mutable_translation()->set_x(Number(random));
  }
}

// The server's side, with the types of the core.
class Oracle {
 public:
  explicit Oracle(const v1::Session& session)
      : goals_(*convert::FromProto(session.goals(), nullptr)) {}

  void Apply(const v1::TargetFrame& frame) {
    goals_ = *convert::Merge(goals_, frame.goal_patch());
    for (const v1::GoalTarget& proto : frame.targets()) {
      Goal& goal = goals_[proto.goal_index()];
      if (proto.has_weight()) goal.weight = proto.weight();
      if (proto.target_case() == v1::GoalTarget::TARGET_NOT_SET) continue;
      GoalTarget target;
      EXPECT_TRUE(convert::FromProto(proto, &target).ok());
      EXPECT_TRUE(Fits(goal.kind, target));
      Retarget(goal.kind, target);
    }
  }

  std::string Print() const {
    v1::Session session;
    convert::ToProto(goals_, session.mutable_goals());
    return session.DebugString();
  }

 private:
  std::vector<Goal> goals_;
};

// Through the core's types, so that unset and default fields compare equal.
std::string Print(const EffectiveGoals& goals) {
  v1::Session session;
  goals.Declare(&session);
  return Oracle(session).Print();
}

v1::Session Declared(const EffectiveGoals& goals) {
  v1::Session session;
  goals.Declare(&session);
  return session;
}

class EffectiveGoalsTest : public ::testing::Test {
 protected:
  EffectiveGoalsTest() {
    for (int i = 0; i < 5; ++i) {
      *session_.add_goals() = RandomGoal(random_, absl::StrCat("goal", i));
    }
  }

  // One that the server accepts.
  v1::TargetFrame RandomFrame(const EffectiveGoals& goals) {
    v1::TargetFrame frame;
    v1::Session session = Declared(goals);
    const int goal_count = session.goals_size();
    if (Index(random_, 4) == 0) {
      v1::GoalPatch* patch = frame.mutable_goal_patch();
      if (goal_count > 2 && Index(random_, 2) == 0) {
        patch->add_removed_goal_ids(
            session.goals(Index(random_, goal_count)).goal_id());
      }
      *patch->add_goals() =
          RandomGoal(random_, absl::StrCat("goal", Index(random_, 9)));
      EffectiveGoals patched(session);
      patched.Apply(frame);
      session = Declared(patched);
    }
    for (int i = 0; i < session.goals_size(); ++i) {
      if (Index(random_, 2) == 0) continue;
      v1::GoalTarget* target = frame.add_targets();
      target->set_goal_index(i);
      const bool has_weight = Index(random_, 3) == 0;
      if (has_weight) target->set_weight(1 + Number(random_));
      if (has_weight && Index(random_, 2) == 0) continue;
      SetRandomTarget(random_, session.goals(i), target);
    }
    if (Index(random_, 5) == 0) {
      frame.mutable_world_from_skeleton()->mutable_translation()->set_y(
          Number(random_));
    }
    return frame;
  }

  Random random_{20};
  v1::Session session_;
};

TEST_F(EffectiveGoalsTest, FollowsTheServerThroughRandomFrames) {
  EffectiveGoals goals(session_);
  Oracle oracle(session_);
  for (int i = 0; i < 500; ++i) {
    const v1::TargetFrame frame = RandomFrame(goals);
    goals.Apply(frame);
    oracle.Apply(frame);
    ASSERT_EQ(Print(goals), oracle.Print()) << frame.DebugString();
  }
}

TEST_F(EffectiveGoalsTest, CompleteFrameLeadsToTheSameFromElsewhere) {
  EffectiveGoals goals(session_);
  for (int i = 0; i < 200; ++i) {
    v1::TargetFrame frame = RandomFrame(goals);
    // The same goals, moved by some other frame without a patch.
    EffectiveGoals elsewhere = goals;
    v1::TargetFrame moved = RandomFrame(goals);
    if (!moved.has_goal_patch()) elsewhere.Apply(moved);
    v1::TargetFrame complete = frame;
    goals.Complete({}, &complete);
    goals.Apply(frame);
    elsewhere.Apply(complete);
    ASSERT_EQ(Print(goals), Print(elsewhere)) << complete.DebugString();
    ASSERT_TRUE(
        MessageDifferencer::Equals(Declared(goals).world_from_skeleton(),
                                   Declared(elsewhere).world_from_skeleton()));
  }
}

TEST_F(EffectiveGoalsTest, SaysNoWeightAndNoPlaceThatIsNotWanted) {
  const EffectiveGoals goals(session_);
  v1::TargetFrame frame;
  goals.Complete({.weights = false, .place = false}, &frame);
  EXPECT_EQ(frame.targets_size(), 5);
  for (const v1::GoalTarget& target : frame.targets()) {
    EXPECT_FALSE(target.has_weight());
    EXPECT_NE(target.target_case(), v1::GoalTarget::TARGET_NOT_SET);
  }
  EXPECT_FALSE(frame.has_world_from_skeleton());
}

TEST_F(EffectiveGoalsTest, PatchThatDoesNotFitChangesNothing) {
  EffectiveGoals goals(session_);
  const std::string before = Print(goals);
  v1::TargetFrame frame;
  frame.mutable_goal_patch()->add_removed_goal_ids("goal0");
  frame.mutable_goal_patch()->add_removed_goal_ids("nobody");
  v1::TargetFrame complete = frame;
  goals.Complete({}, &complete);
  EXPECT_TRUE(MessageDifferencer::Equals(complete, frame));
  goals.Apply(frame);
  EXPECT_EQ(Print(goals), before);
}

TEST_F(EffectiveGoalsTest, PassesOverTargetsThatTheServerRefuses) {
  EffectiveGoals goals(session_);
  const std::string before = Print(goals);
  v1::TargetFrame frame;
  for (int index : {-1, 5, 1000}) {
    v1::GoalTarget* target = frame.add_targets();
    target->set_goal_index(index);
    target->mutable_world_position();
  }
  goals.Apply(frame);
  goals.Complete({}, &frame);
  EXPECT_EQ(Print(goals), before);
}

}  // namespace
}  // namespace gelenk::client
