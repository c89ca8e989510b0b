#include "convert/played_goal.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/clip_layer.h"
#include "convert/geometry.h"
#include "convert/goal.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {

absl::StatusOr<std::vector<TimedGoal>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::PlayedGoal>& protos) {
  Violations violations;
  std::vector<TimedGoal> goals;
  goals.reserve(protos.size());
  for (int i = 0; i < protos.size(); ++i) {
    const v1::PlayedGoal& proto = protos[i];
    absl::StatusOr<Goal> goal = FromProto(proto.goal());
    violations.AddStatus(absl::StrCat("goals[", i, "].goal"), goal.status());
    if (!goal.ok()) continue;
    TimedGoal timed{.goal = *std::move(goal)};
    if (proto.has_weight()) timed.weight = FromProto(proto.weight());
    for (const v1::TargetKey& key : proto.targets()) {
      timed.targets.push_back({key.time_s(), FromProto(key.world_pose())});
    }
    goals.push_back(std::move(timed));
  }
  if (!violations.empty()) return violations.ToStatus();
  return goals;
}

}  // namespace gelenk::convert
