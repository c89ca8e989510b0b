#include "tests/core/ik/goals/solve_goals.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/ik_solver.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/ik_targets.h"

namespace gelenk::testing {

Solved SolveGoals(const std::shared_ptr<const Skeleton>& skeleton,
                  std::vector<Goal> goals, const Eigen::VectorXd& start,
                  const SolverOptions& options) {
  for (size_t i = 0; i < goals.size(); ++i) goals[i].id = absl::StrCat("g", i);
  Solved solved;
  solved.positions = start;
  IkSolver().Solve(IkProblem::Create(skeleton, std::move(goals)).value(),
                   options, SolveStart::kWarm, solved.positions, solved.report);
  return solved;
}

Goal GoalOf(const GoalKind& kind, double weight, int priority) {
  return {"goal", weight, kind, priority};
}

std::shared_ptr<const Skeleton> Leg(bool hinge) {
  SkeletonBuilder builder;
  const auto add = [&](const char* id, const char* parent_id, double down_m) {
    Joint joint;
    joint.id = id;
    joint.parent_id = parent_id;
    joint.type = JointType::kSpherical;
    joint.parent_from_joint.translation = {0, -down_m, 0};
    if (hinge && joint.id == "knee") {
      joint.type = JointType::kRevolute;
      joint.axis = Eigen::Vector3d::UnitX();
      joint.limits.lower = {0};
      joint.limits.upper = {2.5};
    }
    builder.AddJoint(joint);
  };
  add("hip", "", 0);
  add("knee", "hip", 0.45);
  add("ankle", "knee", 0.4);
  builder.AddEndEffector(
      {"sole", "ankle", {Eigen::Quaterniond::Identity(), {0, -0.1, 0}}});
  return builder.Build().value();
}

Eigen::VectorXd HingedLegAt(double swing_rad, double bend_rad) {
  Eigen::VectorXd positions = NeutralPositions(*Leg(true));
  StoreXyzw(ExpRotation({-swing_rad, 0, 0}), positions.data());
  positions[4] = bend_rad;
  return positions;
}

Eigen::Vector3d OriginOf(const Skeleton& skeleton,
                         const Eigen::VectorXd& positions,
                         absl::string_view id) {
  return EffectorPose(skeleton, positions, id).translation;
}

}  // namespace gelenk::testing
