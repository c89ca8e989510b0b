// PoseFrame.continuation: what a session knows beyond its pose, given to the
// client and taken back, here or on another server.
#ifndef GELENK_SERVER_RPC_CONTINUATION_H_
#define GELENK_SERVER_RPC_CONTINUATION_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/math/rigid_transform.h"
#include "server/session/session.h"

namespace gelenk::server {

struct Continuation {
  std::vector<Goal> goals;
  RigidTransform world_from_skeleton;
  JointMotion motion;
  // Of sessions that follow a source; empty where it is of no use here.
  std::vector<double> memory;
  // Empty when going on is exact, else why it is not.
  std::string inexact_because;
};

std::string WriteContinuation(const Session& session, InstructionSet level);

// INVALID_ARGUMENT for bytes that are no continuation of this format. Goals are
// checked when the session takes them.
absl::StatusOr<Continuation> ReadContinuation(const std::string& bytes,
                                              InstructionSet level);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_CONTINUATION_H_
