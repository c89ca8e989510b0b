// Goals and their targets between the contract and the core.
//
// Errors: INVALID_ARGUMENT for what the core's types cannot hold (no kind, no
// target); the rest is checked by IkProblem.
#ifndef GELENK_CONVERT_GOAL_H_
#define GELENK_CONVERT_GOAL_H_

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/ik.pb.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::convert {

absl::StatusOr<Goal> FromProto(const v1::Goal& proto);

// `skeleton`, where it is known, is what the goals are for. Where a kind is
// missing the violations are those of all goals, of what IkProblem checks too.
absl::StatusOr<std::vector<Goal>> FromProto(
    const google::protobuf::RepeatedPtrField<v1::Goal>& protos,
    const Skeleton* skeleton);

void ToProto(const Goal& goal, v1::Goal* proto);
void ToProto(absl::Span<const Goal> goals,
             google::protobuf::RepeatedPtrField<v1::Goal>* protos);

// The hot path: allocates nothing but for a posture. INVALID_ARGUMENT when no
// target is set.
absl::Status FromProto(const v1::GoalTarget& proto, GoalTarget* target);

// `goals` with `patch` merged in by id; existing goals keep their places, and
// removed ones close the gap.
absl::StatusOr<std::vector<Goal>> Merge(absl::Span<const Goal> goals,
                                        const v1::GoalPatch& patch);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_GOAL_H_
