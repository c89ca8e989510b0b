// Holds a retargeted pose inside the joint limits of its skeleton.
//
// A pose inside them stays as it is, for the price of a look. One that breaks
// them is moved to the nearest allowed numbers and solved again, limits inside
// the step (LevenbergMarquardtSolver): the feet first, then the hands, the rest
// as near to the wanted pose as that allows.
#ifndef GELENK_RETARGET_LIMIT_KEEPER_H_
#define GELENK_RETARGET_LIMIT_KEEPER_H_

#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class LimitKeeper {
 public:
  // Errors: none that a body model of a valid skeleton can cause; passed on.
  static absl::StatusOr<LimitKeeper> Create(
      std::shared_ptr<const BodyModel> target);

  // Whether any joint of the skeleton is limited.
  bool HasLimits() const { return has_limits_; }

  // Returns by how much `positions` broke the limits at worst, rad or m; 0
  // inside. Allocates nothing once it has solved.
  double Keep(VectorView positions);

 private:
  struct EndGoal {
    int goal;
    int joint;
    bool has_rotation;
  };

  LimitKeeper(std::shared_ptr<const BodyModel> target, IkProblem problem,
              std::vector<EndGoal> ends, int posture);

  std::shared_ptr<const BodyModel> target_;
  bool has_limits_;
  IkProblem problem_;
  std::vector<EndGoal> ends_;
  int posture_;
  LevenbergMarquardtSolver solver_;
  SolverOptions options_;
  SolveReport report_;
  WorldTransforms wanted_;
  GoalTarget posture_target_;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_LIMIT_KEEPER_H_
