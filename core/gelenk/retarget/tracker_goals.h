// Goals of a stream as trackers: a pose goal named after a part of the person
// is the tracker on that part.
#ifndef GELENK_RETARGET_TRACKER_GOALS_H_
#define GELENK_RETARGET_TRACKER_GOALS_H_

#include <array>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/retarget/tracker_body.h"

namespace gelenk {

inline constexpr std::array<absl::string_view, 6> kTrackerIds = {
    "head", "left_hand", "right_hand", "waist", "left_foot", "right_foot"};

// The place in `frame` of the tracker named `id`; null for other names.
std::optional<RigidTransform>* FindTracker(absl::string_view id,
                                           TrackerFrame& frame);

// INVALID_ARGUMENT naming every goals[i] that is no pose goal or has another
// name, and "goals" when there is no head among them.
absl::Status CheckTrackerGoals(absl::Span<const Goal> goals);

// Checked goals where they are now; those of weight 0 are lost. Allocates
// nothing.
TrackerFrame TrackersOf(absl::Span<const Goal> goals,
                        const RigidTransform& canonical_from_world);

}  // namespace gelenk

#endif  // GELENK_RETARGET_TRACKER_GOALS_H_
