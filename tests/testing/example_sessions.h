// Sessions without a server around them.
#ifndef GELENK_TESTS_TESTING_EXAMPLE_SESSIONS_H_
#define GELENK_TESTS_TESTING_EXAMPLE_SESSIONS_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "gelenk/ik/goal.h"
#include "server/session/session.h"

namespace gelenk::testing {

// Places of ArmGoals.
inline constexpr int kReach = 0;
inline constexpr int kAim = 1;
inline constexpr int kGrip = 2;

// One goal of each kind for a planar arm: "reach" a point with the tip, "aim"
// j1, "grip" with the tip.
std::vector<Goal> ArmGoals();

// sessions/arm on three links of 0.5 m, with ArmGoals, warm, living for ten
// minutes from `now` on.
std::shared_ptr<server::Session> ArmSession(absl::Time now);
std::shared_ptr<server::Session> ArmSession(absl::Time now,
                                            std::vector<Goal> goals,
                                            server::SessionState state = {});

// The same by another name, on skeletons/arm.
std::shared_ptr<server::Session> ArmSessionNamed(std::string name,
                                                 absl::Time now);

// A frame that moves "reach" only.
server::InputFrame ReachFrame(int64_t sequence_number, double x_m, double y_m);

// A frame that names every goal.
server::InputFrame WholeFrame(int64_t sequence_number, double x_m, double y_m);

// All that is to be seen of a session but its times: two sessions, or one
// before and after, are alike when these are.
std::string StateOf(const server::Session& session);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_EXAMPLE_SESSIONS_H_
