// What a stream keeps about a session, to make it and to make it again.
#ifndef GELENK_CLIENT_SESSION_SPEC_H_
#define GELENK_CLIENT_SESSION_SPEC_H_

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "gelenk/v1/kinematics_service.pb.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::client {

struct SessionSpec {
  // The skeleton to create; without `skeleton.skeleton`, the one that the
  // session names is there already.
  v1::CreateSkeletonRequest skeleton;
  // The same for the skeleton of the poses that a session with retargeting
  // follows.
  v1::CreateSkeletonRequest source_skeleton;
  // The session to create; without `session.session`, the one that is named by
  // `session.session_id` is there already: what is needed to create it again is
  // then read from the server.
  //
  // An id or request id that is empty is chosen by the library. An empty
  // `session.session.skeleton` means the skeleton above, likewise an empty
  // `session.session.retargeting.source_skeleton` where there is one.
  v1::CreateSessionRequest session;
  v1::FramePolicy frame_policy = v1::FRAME_POLICY_LATEST_WINS;
  bool include_joint_frames = false;
  // The whole report every n-th frame.
  int report_interval = 1;
  // Take the session from its present driver, the first time. A stream that
  // comes back after a loss never does.
  bool take_over = false;
};

// sessions/{session}
std::string SessionName(const SessionSpec& spec);

// The metadata `gelenk-session` that keeps this session on its server.
std::string AffinityKey(const SessionSpec& spec);

// Fills in ids, request ids and names. INVALID_ARGUMENT when `specs` is empty,
// names a session twice, names no session, or has more than one affinity key:
// sessions that share a stream live on one server.
absl::Status Complete(std::vector<SessionSpec>* specs, std::mt19937_64& random);

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_SESSION_SPEC_H_
