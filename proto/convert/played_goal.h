// Goals on top of clips between the contract and the core.
#ifndef GELENK_CONVERT_PLAYED_GOAL_H_
#define GELENK_CONVERT_PLAYED_GOAL_H_

#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/motion/goal_overlay.h"
#include "gelenk/v1/motion_service.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT naming "goals[i].goal" where a goal wishes nothing;
// GoalOverlay::Create checks the rest.
absl::StatusOr<std::vector<TimedGoal>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::PlayedGoal>& protos);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_PLAYED_GOAL_H_
