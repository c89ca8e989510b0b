// What can be said about a pose besides how near it is: how far it moved, and
// how the goals' Jacobian is conditioned there.
#ifndef GELENK_IK_SOLVE_DIAGNOSIS_H_
#define GELENK_IK_SOLVE_DIAGNOSIS_H_

#include <Eigen/Core>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// sqrt(sum over degrees of freedom of stiffness * change^2) between two poses;
// `change` (size velocity_count) receives their difference.
double WeightedChange(const IkProblem& problem, const ConstVectorView& from,
                      const ConstVectorView& to, VectorView change);

// Fills rank (see kRankCutoff), free_velocity_count and the manipulabilities of
// `report`. Takes the unweighted rows of all goals that are on. Allocates.
void Diagnose(const IkProblem& problem, const ConstVectorView& positions,
              SolveReport& report);

}  // namespace gelenk

#endif  // GELENK_IK_SOLVE_DIAGNOSIS_H_
