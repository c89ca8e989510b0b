// How far a solve threw a point beyond the plane that it was to come to.
//
// A half-space pulls as long as its point is behind the plane and lets go when
// it is through, so that a long step may end well beyond. The steps of
// LevenbergMarquardtSolver are such; those of PrioritizedSolver bind the point
// to its plane.
#ifndef GELENK_IK_HALF_SPACE_OVERSHOOT_H_
#define GELENK_IK_HALF_SPACE_OVERSHOOT_H_

#include "gelenk/ik/ik_problem.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// The largest clearance at `end`, m, of the half-spaces that are on and whose
// points were behind their planes at `start`; 0 without. Cost: some ns without
// half-spaces, else forward kinematics of their points, twice.
double HalfSpaceOvershoot(const IkProblem& problem,
                          const ConstVectorView& start,
                          const ConstVectorView& end);

}  // namespace gelenk

#endif  // GELENK_IK_HALF_SPACE_OVERSHOOT_H_
