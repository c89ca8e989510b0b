// The algorithms that solve an IkProblem, by name. IkSolver says which of them
// fits which problem.
#ifndef GELENK_IK_SOLVER_METHOD_H_
#define GELENK_IK_SOLVER_METHOD_H_

#include "absl/strings/string_view.h"

namespace gelenk {

enum class SolverMethod {
  // IkSolver picks.
  kAuto,
  // Closed form: two links in a plane.
  kTwoLink,
  // Newton with the inverse Jacobian: as many equations as unknowns.
  kNewton,
  // Newton with the pseudo-inverse: each step is minimal.
  kPseudoInverse,
  // The whole change is minimal among all solutions.
  kMinimalChange,
  // Damped least squares with limits inside the step and restarts.
  kLevenbergMarquardt,
  // Long chains that reach for points.
  kFabrik,
};

// "auto", "two-link", "newton", "pseudo-inverse", "minimal-change",
// "levenberg-marquardt", "fabrik".
absl::string_view SolverMethodName(SolverMethod method);

}  // namespace gelenk

#endif  // GELENK_IK_SOLVER_METHOD_H_
