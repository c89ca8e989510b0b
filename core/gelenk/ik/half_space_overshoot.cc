#include "gelenk/ik/half_space_overshoot.h"

#include <algorithm>

namespace gelenk {
namespace {

double Clearance(const IkProblem& problem, const HalfSpaceGoal& goal,
                 const ConstVectorView& positions) {
  const RigidTransform world_from_effector =
      WorldFromEffector(problem, goal.end_effector_id, positions);
  return goal.world_normal.dot(world_from_effector.translation) - goal.offset_m;
}

}  // namespace

double HalfSpaceOvershoot(const IkProblem& problem,
                          const ConstVectorView& start,
                          const ConstVectorView& end) {
  double most = 0;
  for (const Goal& goal : problem.goals()) {
    const auto* half_space = std::get_if<HalfSpaceGoal>(&goal.kind);
    if (half_space == nullptr || goal.weight == 0) continue;
    const double clearance = Clearance(problem, *half_space, end);
    if (clearance <= most || Clearance(problem, *half_space, start) >= 0) {
      continue;
    }
    most = clearance;
  }
  return most;
}

}  // namespace gelenk
