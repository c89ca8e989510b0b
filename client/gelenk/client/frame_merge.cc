#include "gelenk/client/frame_merge.h"

namespace gelenk::client {
namespace {

// Trackers name the same goals in the same order in every frame, so looking at
// `guess` first finds nearly all of them.
v1::GoalTarget* FindOrAdd(int goal_index, int guess, v1::TargetFrame* frame) {
  if (guess < frame->targets_size() &&
      frame->targets(guess).goal_index() == goal_index) {
    return frame->mutable_targets(guess);
  }
  for (v1::GoalTarget& target : *frame->mutable_targets()) {
    if (target.goal_index() == goal_index) return &target;
  }
  return frame->add_targets();
}

void Merge(const v1::GoalTarget& newer, v1::GoalTarget* older) {
  // One without a target changes the weight alone.
  if (newer.target_case() == v1::GoalTarget::TARGET_NOT_SET) {
    older->set_goal_index(newer.goal_index());
    if (newer.has_weight()) older->set_weight(newer.weight());
    return;
  }
  const bool keeps_weight = older->has_weight() && !newer.has_weight();
  const double weight = older->weight();
  *older = newer;
  if (keeps_weight) older->set_weight(weight);
}

}  // namespace

bool Merge(const v1::TargetFrame& newer, v1::TargetFrame* older) {
  if (newer.has_goal_patch()) return false;
  older->set_sequence_number(newer.sequence_number());
  if (newer.has_capture_time()) {
    *older->mutable_capture_time() = newer.capture_time();
  } else {
    older->clear_capture_time();
  }
  for (int i = 0; i < newer.targets_size(); ++i) {
    const v1::GoalTarget& target = newer.targets(i);
    Merge(target, FindOrAdd(target.goal_index(), i, older));
  }
  if (newer.has_source_pose()) {
    *older->mutable_source_pose() = newer.source_pose();
  }
  if (newer.has_world_from_skeleton()) {
    *older->mutable_world_from_skeleton() = newer.world_from_skeleton();
  }
  return true;
}

}  // namespace gelenk::client
