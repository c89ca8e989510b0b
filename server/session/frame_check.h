// Checks what a frame says to a problem, before any of it is taken.
#ifndef GELENK_SERVER_SESSION_FRAME_CHECK_H_
#define GELENK_SERVER_SESSION_FRAME_CHECK_H_

#include "absl/status/status.h"
#include "gelenk/ik/ik_problem.h"
#include "server/session/input_frame.h"

namespace gelenk::server {

// Every update and the place of `frame` against `problem`; rotations are
// normalised as it goes. All faults at once, as `targets[2].weight`.
absl::Status CheckFrame(const IkProblem& problem, InputFrame& frame);

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_FRAME_CHECK_H_
