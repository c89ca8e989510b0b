#include "gelenk/retarget/tracker_goals.h"

#include <variant>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "gelenk/base/violations.h"

namespace gelenk {

std::optional<RigidTransform>* FindTracker(absl::string_view id,
                                           TrackerFrame& frame) {
  const std::array<std::optional<RigidTransform>*, 6> places = {
      &frame.head,  &frame.hands[kLeft], &frame.hands[kRight],
      &frame.waist, &frame.feet[kLeft],  &frame.feet[kRight]};
  for (size_t i = 0; i < kTrackerIds.size(); ++i) {
    if (id == kTrackerIds[i]) return places[i];
  }
  return nullptr;
}

absl::Status CheckTrackerGoals(absl::Span<const Goal> goals) {
  Violations violations;
  bool has_head = false;
  TrackerFrame frame;
  for (size_t i = 0; i < goals.size(); ++i) {
    const Goal& goal = goals[i];
    has_head |= goal.id == kTrackerIds[0];
    if (FindTracker(goal.id, frame) == nullptr) {
      violations.Add(absl::StrCat("goals[", i, "].goal_id"),
                     absl::StrCat("want a tracker, one of ",
                                  absl::StrJoin(kTrackerIds, ", "), ", got \"",
                                  goal.id, "\""));
    } else if (!std::holds_alternative<PoseGoal>(goal.kind)) {
      violations.Add(absl::StrCat("goals[", i, "]"),
                     absl::StrCat("want a pose of the tracker \"", goal.id,
                                  "\", got ", GoalKindName(goal.kind)));
    }
  }
  if (!has_head) violations.Add("goals", "want the tracker \"head\"");
  return violations.ToStatus();
}

TrackerFrame TrackersOf(absl::Span<const Goal> goals,
                        const RigidTransform& canonical_from_world) {
  TrackerFrame frame;
  for (const Goal& goal : goals) {
    if (goal.weight == 0) continue;
    *FindTracker(goal.id, frame) =
        canonical_from_world * std::get<PoseGoal>(goal.kind).world_pose;
  }
  return frame;
}

}  // namespace gelenk
