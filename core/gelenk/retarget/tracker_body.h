// A whole body from a few trackers: head and hands, with or without waist and
// feet, as headsets and motion suits of few sensors give them.
//
// The trackers pull the bundled humanoid, made as tall as the person, by
// inverse kinematics; what is not tracked stays near a relaxed posture, hips
// stay below the head and turn after it, and feet step after the hips
// (step_planner.h). The humanoid's pose is then a source like any other:
// Retargeter takes it on to any body.
//
//   TrackerFrame -> TrackerBody -> positions of its humanoid -> Retargeter
//
// Canonical coordinates: m, Y up, ground at 0. Added latency: none. Allocates
// nothing from the second frame on. Not thread-safe.
#ifndef GELENK_RETARGET_TRACKER_BODY_H_
#define GELENK_RETARGET_TRACKER_BODY_H_

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gelenk/ik/levenberg_marquardt_solver.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/humanoid.h"
#include "gelenk/retarget/step_planner.h"

namespace gelenk {

// canonical_from_tracker; unset is not tracked, or lost in this frame.
struct TrackerFrame {
  std::optional<RigidTransform> head;
  std::array<std::optional<RigidTransform>, 2> hands;
  std::optional<RigidTransform> waist;
  std::array<std::optional<RigidTransform>, 2> feet;
};

class TrackerBody {
 public:
  // Errors: INVALID_ARGUMENT naming a `height_m` that is not of a person
  // (0.5 to 3).
  static absl::StatusOr<std::unique_ptr<TrackerBody>> Create(
      double height_m = kHumanoidHeightM,
      InstructionSet level = BestInstructionSet());

  TrackerBody(const TrackerBody&) = delete;
  TrackerBody& operator=(const TrackerBody&) = delete;

  // Of the humanoid: the source model for Retargeter.
  const std::shared_ptr<const BodyModel>& model() const { return model_; }

  // Learns how the trackers are mounted, from a frame in which the person
  // stands in a T-pose at the origin, facing +Z. Without it a tracker is taken
  // to be in the joint of its part (head, wrist, hips, ankle), its axes those
  // of the canonical T-pose. Trackers that the frame lacks keep their mounts.
  void Calibrate(const TrackerFrame& t_pose);

  // The frame `dt_s` after the one before. Lost trackers are held where they
  // were, relative to the hips, until they are back. Errors: INVALID_ARGUMENT
  // naming the tracker whose pose is not finite or not unit, a head that has
  // never been tracked, or `dt_s`; the state is then unchanged.
  absl::Status Update(const TrackerFrame& frame, double dt_s);

  // The humanoid's.
  const Eigen::VectorXd& positions() const { return positions_; }

  void Reset();

  // Whether there is a head to hang the body on, now or in memory.
  bool KnowsHead() const { return waist_from_part_[kHead].has_value(); }

  // All that later frames depend on; see Retargeter::Exchange.
  void Exchange(StateNumbers& state);

 private:
  // In the order of the goals.
  enum Part { kHead, kLeftHand, kRightHand, kWaist, kLeftFoot, kRightFoot };
  static constexpr int kPartCount = 6;
  using Parts = std::array<std::optional<RigidTransform>, kPartCount>;

  TrackerBody(std::shared_ptr<const BodyModel> model, IkProblem problem,
              InstructionSet level);

  static Parts PartsOf(const TrackerFrame& frame);
  // Where hips that are not tracked should be.
  RigidTransform GuessWaist(const Parts& tracked, double dt_s);
  void Aim(int part, const RigidTransform& canonical_from_part, double weight);

  std::shared_ptr<const BodyModel> model_;
  IkProblem problem_;
  LevenbergMarquardtSolver solver_;
  SolverOptions options_;
  SolveReport report_;
  StepPlanner steps_;
  // tracker_from_part.
  std::array<RigidTransform, kPartCount> mounts_;
  // The parts at rest, and the hips below a standing head.
  std::array<RigidTransform, kPartCount> rest_;
  WorldTransforms world_from_joints_;
  // Last known places in the frame of the hips.
  Parts waist_from_part_;
  Eigen::VectorXd relaxed_;
  Eigen::VectorXd positions_;
  double yaw_rad_ = 0;
  bool is_first_ = true;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_TRACKER_BODY_H_
