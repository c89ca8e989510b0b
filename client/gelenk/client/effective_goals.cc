#include "gelenk/client/effective_goals.h"

#include <algorithm>
#include <string>
#include <vector>

namespace gelenk::client {
namespace {

using Goals = google::protobuf::RepeatedPtrField<v1::Goal>;

Goals::iterator Find(Goals& goals, const std::string& goal_id) {
  return std::find_if(
      goals.begin(), goals.end(),
      [&goal_id](const v1::Goal& goal) { return goal.goal_id() == goal_id; });
}

// The point of the kinds that have one, null otherwise.
v1::Vector3* MutablePoint(v1::Goal& goal) {
  switch (goal.kind_case()) {
    case v1::Goal::kPosition:
      return goal.mutable_position()->mutable_world_position();
    case v1::Goal::kAim:
      return goal.mutable_aim()->mutable_world_point();
    case v1::Goal::kPole:
      return goal.mutable_pole()->mutable_world_point();
    case v1::Goal::kCenterOfMass:
      return goal.mutable_center_of_mass()->mutable_world_position();
    default:
      return nullptr;
  }
}

// False when `target` does not fit the kind of `goal`, which then is as before.
bool ReplaceTarget(const v1::GoalTarget& target, v1::Goal& goal) {
  switch (target.target_case()) {
    case v1::GoalTarget::kWorldPosition: {
      v1::Vector3* point = MutablePoint(goal);
      if (point != nullptr) *point = target.world_position();
      return point != nullptr;
    }
    case v1::GoalTarget::kWorldRotation:
      if (!goal.has_rotation()) return false;
      *goal.mutable_rotation()->mutable_world_rotation() =
          target.world_rotation();
      return true;
    case v1::GoalTarget::kWorldPose:
      if (!goal.has_pose()) return false;
      *goal.mutable_pose()->mutable_world_pose() = target.world_pose();
      return true;
    case v1::GoalTarget::kReferenceFromEndEffector:
      if (!goal.has_relative()) return false;
      *goal.mutable_relative()->mutable_reference_from_end_effector() =
          target.reference_from_end_effector();
      return true;
    case v1::GoalTarget::kPosture:
      if (!goal.has_posture()) return false;
      *goal.mutable_posture()->mutable_pose() = target.posture();
      return true;
    case v1::GoalTarget::kPlane:
      if (!goal.has_half_space()) return false;
      *goal.mutable_half_space()->mutable_plane() = target.plane();
      return true;
    case v1::GoalTarget::TARGET_NOT_SET:
      break;
  }
  return true;
}

void ApplyTarget(const v1::GoalTarget& target, v1::Goal* goal) {
  if (!ReplaceTarget(target, *goal)) return;
  if (target.has_weight()) goal->set_weight(target.weight());
}

double WeightOf(const v1::Goal& goal) {
  return goal.has_weight() ? goal.weight() : 1;
}

// Says aloud what unset fields mean. A goal without a target says its weight: a
// plant, a half-space above the ground.
void StateTarget(const v1::Goal& goal, v1::GoalTarget* target) {
  v1::Goal copy = goal;
  if (const v1::Vector3* point = MutablePoint(copy)) {
    *target->mutable_world_position() = *point;
  } else if (goal.has_rotation()) {
    if (goal.rotation().has_world_rotation()) {
      *target->mutable_world_rotation() = goal.rotation().world_rotation();
    } else {
      target->mutable_world_rotation()->set_w(1);
    }
  } else if (goal.has_pose()) {
    *target->mutable_world_pose() = goal.pose().world_pose();
  } else if (goal.has_relative()) {
    *target->mutable_reference_from_end_effector() =
        goal.relative().reference_from_end_effector();
  } else if (goal.has_posture()) {
    *target->mutable_posture() = goal.posture().pose();
  } else if (goal.half_space().has_plane()) {
    *target->mutable_plane() = goal.half_space().plane();
  } else {
    target->set_weight(WeightOf(goal));
  }
}

// `change` of a goal that is there: what is set of weight and kind counts.
void Change(const v1::Goal& change, v1::Goal* goal) {
  v1::Goal changed =
      change.kind_case() == v1::Goal::KIND_NOT_SET ? *goal : change;
  if (change.has_weight()) {
    changed.set_weight(change.weight());
  } else if (goal->has_weight()) {
    changed.set_weight(goal->weight());
  }
  *goal = std::move(changed);
}

}  // namespace

EffectiveGoals::EffectiveGoals(const v1::Session& session)
    : goals_(session.goals()),
      world_from_skeleton_(session.world_from_skeleton()) {}

void EffectiveGoals::Apply(const v1::TargetFrame& frame) {
  if (frame.has_goal_patch() && !ApplyPatch(frame.goal_patch())) return;
  for (const v1::GoalTarget& target : frame.targets()) {
    if (target.goal_index() < 0 || target.goal_index() >= goals_.size()) {
      continue;
    }
    ApplyTarget(target, goals_.Mutable(target.goal_index()));
  }
  if (frame.has_world_from_skeleton()) {
    world_from_skeleton_ = frame.world_from_skeleton();
  }
}

void EffectiveGoals::Complete(const Wanted& wanted,
                              v1::TargetFrame* frame) const {
  EffectiveGoals patched = *this;
  if (frame->has_goal_patch() && !patched.ApplyPatch(frame->goal_patch())) {
    return;
  }
  const int goal_count = patched.goals_.size();
  std::vector<v1::GoalTarget*> targets(goal_count, nullptr);
  for (v1::GoalTarget& target : *frame->mutable_targets()) {
    const int index = target.goal_index();
    if (index >= 0 && index < goal_count) targets[index] = &target;
  }
  for (int index = 0; index < goal_count; ++index) {
    const v1::Goal& goal = patched.goals_[index];
    v1::GoalTarget* target = targets[index];
    if (target == nullptr) {
      target = frame->add_targets();
      target->set_goal_index(index);
    }
    if (target->target_case() == v1::GoalTarget::TARGET_NOT_SET) {
      StateTarget(goal, target);
    }
    if (wanted.weights && !target->has_weight()) {
      target->set_weight(WeightOf(goal));
    }
  }
  if (wanted.place && !frame->has_world_from_skeleton()) {
    *frame->mutable_world_from_skeleton() = world_from_skeleton_;
  }
}

void EffectiveGoals::Declare(v1::Session* session) const {
  *session->mutable_goals() = goals_;
  *session->mutable_world_from_skeleton() = world_from_skeleton_;
}

bool EffectiveGoals::ApplyPatch(const v1::GoalPatch& patch) {
  Goals merged = goals_;
  for (const std::string& goal_id : patch.removed_goal_ids()) {
    const auto found = Find(merged, goal_id);
    if (found == merged.end()) return false;
    merged.erase(found);
  }
  for (const v1::Goal& change : patch.goals()) {
    const auto found = Find(merged, change.goal_id());
    if (found != merged.end()) {
      Change(change, &*found);
    } else if (change.kind_case() != v1::Goal::KIND_NOT_SET) {
      *merged.Add() = change;
    } else {
      return false;
    }
  }
  goals_ = std::move(merged);
  return true;
}

}  // namespace gelenk::client
