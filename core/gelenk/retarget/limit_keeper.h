// Makes a retargeted pose one that the skeleton can take.
//
// Of ball joints inside their limits a pose stays as it is, for the price of a
// look. One that breaks limits is moved to the nearest allowed numbers and
// solved again, limits inside the step (LevenbergMarquardtSolver): the feet
// first, then the hands, the rest as near to the wanted pose as that allows.
// Where roles hang on joints of a single axis, as on robots, every frame is
// solved, from the one before, with the orientations of the bones as goals
// beside.
#ifndef GELENK_RETARGET_LIMIT_KEEPER_H_
#define GELENK_RETARGET_LIMIT_KEEPER_H_

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/rig_pose.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class LimitKeeper {
 public:
  // Solves at `level`. Errors: none that a body model of a valid skeleton can
  // cause; passed on.
  static absl::StatusOr<LimitKeeper> Create(
      std::shared_ptr<const BodyModel> target, InstructionSet level);

  void Reset();
  void Exchange(StateNumbers& state);

  // Whether roles hang on single axes: then every frame is solved.
  bool SolvesEveryFrame() const { return solves_every_frame_; }

  // `positions` are those that `rig` stored. Returns by how much they broke the
  // limits at worst, rad or m; 0 inside. With `keep_limits` off only robots are
  // solved. Allocates nothing once it has solved.
  double Keep(const RigPose& rig, bool keep_limits, VectorView positions);

 private:
  enum class Aim { kPose, kPosition, kRotation };
  struct PartGoal {
    int joint;
    Aim aim;
  };

  LimitKeeper(std::shared_ptr<const BodyModel> target, IkProblem problem,
              std::vector<PartGoal> parts, bool solves_every_frame,
              InstructionSet level);

  void AimParts(const RigPose& rig, const ConstVectorView& posture);
  void Solve(VectorView positions);

  std::shared_ptr<const BodyModel> target_;
  IkProblem problem_;
  // One for each goal but the last, which is the posture.
  std::vector<PartGoal> parts_;
  bool solves_every_frame_;
  bool has_limits_;
  bool is_first_ = true;
  LevenbergMarquardtSolver solver_;
  SolverOptions options_;
  SolveReport report_;
  GoalTarget posture_target_;
  Eigen::VectorXd last_;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_LIMIT_KEEPER_H_
