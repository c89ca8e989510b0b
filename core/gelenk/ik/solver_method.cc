#include "gelenk/ik/solver_method.h"

namespace gelenk {

absl::string_view SolverMethodName(SolverMethod method) {
  switch (method) {
    case SolverMethod::kAuto:
      return "auto";
    case SolverMethod::kTwoLink:
      return "two-link";
    case SolverMethod::kNewton:
      return "newton";
    case SolverMethod::kPseudoInverse:
      return "pseudo-inverse";
    case SolverMethod::kMinimalChange:
      return "minimal-change";
    case SolverMethod::kLevenbergMarquardt:
      return "levenberg-marquardt";
    case SolverMethod::kFabrik:
      return "fabrik";
  }
  return "";
}

}  // namespace gelenk
