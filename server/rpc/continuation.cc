#include "server/rpc/continuation.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/duration.h"
#include "convert/geometry.h"
#include "convert/goal.h"
#include "gelenk/base/violations.h"
#include "gelenk/internal/v1/continuation.pb.h"
#include "server/version.h"

namespace gelenk::server {
namespace {

// Raised whenever the meaning of SessionContinuation changes.
constexpr int kFormat = 1;

absl::Status Unreadable(absl::string_view why) {
  Violations violations;
  violations.Add("resume_from.continuation", why);
  return violations.ToStatus();
}

}  // namespace

std::string WriteContinuation(const Session& session, InstructionSet level) {
  const SessionSnapshot snapshot = session.Snapshot();
  internal::v1::SessionContinuation proto;
  proto.set_format(kFormat);
  proto.set_build(BuildId());
  proto.set_instruction_set(std::string(InstructionSetName(level)));
  convert::ToProto(snapshot.state.goals, proto.mutable_goals());
  convert::ToProto(snapshot.state.world_from_skeleton,
                   proto.mutable_world_from_skeleton());
  const JointMotion& motion = snapshot.motion;
  if (motion.capture_time) {
    convert::ToProto(*motion.capture_time, proto.mutable_capture_time());
    proto.mutable_velocity()->Assign(motion.velocity.begin(),
                                     motion.velocity.end());
  }
  proto.mutable_memory()->Assign(snapshot.memory.begin(),
                                 snapshot.memory.end());
  return proto.SerializeAsString();
}

absl::StatusOr<Continuation> ReadContinuation(const std::string& bytes,
                                              InstructionSet level) {
  internal::v1::SessionContinuation proto;
  if (!proto.ParseFromString(bytes)) return Unreadable("is no continuation");
  if (proto.format() != kFormat) {
    return Unreadable(
        absl::StrCat("want format ", kFormat, ", got ", proto.format()));
  }
  absl::StatusOr<std::vector<Goal>> goals =
      convert::FromProto(proto.goals(), nullptr);
  if (!goals.ok()) return goals.status();
  Continuation continuation;
  continuation.goals = *std::move(goals);
  continuation.world_from_skeleton =
      convert::FromProto(proto.world_from_skeleton());
  if (proto.has_capture_time()) {
    continuation.motion.capture_time = convert::FromProto(proto.capture_time());
    continuation.motion.velocity = Eigen::Map<const Eigen::VectorXd>(
        proto.velocity().data(), proto.velocity_size());
  }
  const std::string name(InstructionSetName(level));
  // Another build may remember other things.
  if (proto.build() == BuildId()) {
    continuation.memory.assign(proto.memory().begin(), proto.memory().end());
  }
  if (proto.build() != BuildId()) {
    continuation.inexact_because = absl::StrCat(
        "not exact: build ", proto.build(), " before, ", BuildId(), " here");
  } else if (proto.instruction_set() != name) {
    continuation.inexact_because =
        absl::StrCat("not exact: instruction set ", proto.instruction_set(),
                     " before, ", name, " here");
  }
  return continuation;
}

}  // namespace gelenk::server
