// What a goal wishes, kind by kind, between the contract and the core.
#ifndef GELENK_CONVERT_GOAL_KIND_H_
#define GELENK_CONVERT_GOAL_KIND_H_

#include <optional>

#include "gelenk/ik/goal.h"
#include "gelenk/v1/ik.pb.h"

namespace gelenk::convert {

// None when no kind is set.
std::optional<GoalKind> KindFromProto(const v1::Goal& proto);

void KindToProto(const GoalKind& kind, v1::Goal* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_GOAL_KIND_H_
