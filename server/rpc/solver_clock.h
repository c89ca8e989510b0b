// The clock by which time limits of solves are kept.
#ifndef GELENK_SERVER_RPC_SOLVER_CLOCK_H_
#define GELENK_SERVER_RPC_SOLVER_CLOCK_H_

#include <chrono>

#include "absl/time/time.h"

namespace gelenk::server {

inline absl::Duration SolverClock() {
  return absl::FromChrono(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_SOLVER_CLOCK_H_
