// Moves another body as a source moves: online, frame by frame, without
// look-ahead.
//
//   source pose -> BodyPose -> contacts -> copied rotations -> planted feet ->
//   pelvis -> legs and arms -> joint limits -> target pose
//
// Rotations are carried over as anatomical ones, so that rest poses, axes and
// rolls do not matter (body_model.h). The root goes as far as the legs are
// longer; feet and hands go where they are relative to hips and shoulders, by
// the lengths of legs and arms; planted feet stay where they are and out of the
// ground; limits of the target's joints hold. The method, what it gives and
// what it does not: docs/retargeting.md.
//
// Added latency: none. A warm frame allocates nothing. Not thread-safe; models
// may be shared.
#ifndef GELENK_RETARGET_RETARGETER_H_
#define GELENK_RETARGET_RETARGETER_H_

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "gelenk/contact/contact_detector.h"
#include "gelenk/contact/ground.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"
#include "gelenk/retarget/foot_planter.h"
#include "gelenk/retarget/limb_placement.h"
#include "gelenk/retarget/limit_keeper.h"
#include "gelenk/retarget/rotation_transfer.h"

namespace gelenk {

struct RetargetOptions {
  // Under the source, in its canonical coordinates; null: its floor is
  // estimated.
  std::shared_ptr<const Ground> source_ground;
  // Under the target; null: flat, at height 0.
  std::shared_ptr<const Ground> target_ground;
  // Feet and hands as goals; without, rotations are copied and nothing else.
  bool place_limbs = true;
  bool plant_feet = true;
  bool keep_limits = true;
  ContactThresholds contact_thresholds;
  // Way over the ground of the target for a way 1 of the source, > 0; unset: as
  // much as its legs are longer.
  std::optional<double> root_scale;
  // What solves where joint limits are broken.
  InstructionSet instruction_set = BestInstructionSet();
};

// What a frame took.
struct RetargetReport {
  FootContacts contacts = {};
  // Of the source, under its feet, m; as far as it is known.
  double source_floor_m = 0;
  // The way of the pelvis beside the copied pose.
  Eigen::Vector3d pelvis_shift = Eigen::Vector3d::Zero();
  // Distances of hands and feet from their goals, m.
  std::array<double, 2> hand_error_m = {};
  std::array<double, 2> foot_error_m = {};
  // By how much the pose would have broken limits at worst, rad or m.
  double limit_excess = 0;
};

class Retargeter {
 public:
  // Longer gaps between frames than this are not motion.
  static constexpr double kMaxFrameTime_s = 10;

  // Errors: INVALID_ARGUMENT when source and target have nothing in common.
  static absl::StatusOr<std::unique_ptr<Retargeter>> Create(
      std::shared_ptr<const BodyModel> source,
      std::shared_ptr<const BodyModel> target,
      const RetargetOptions& options = {});

  Retargeter(const Retargeter&) = delete;
  Retargeter& operator=(const Retargeter&) = delete;

  // The source's frame, `dt_s` after the one before (of the first it does not
  // matter). Errors: INVALID_ARGUMENT naming `positions` (see CheckPositions)
  // or `dt_s`; the state is then unchanged.
  absl::Status Retarget(const ConstVectorView& source_positions, double dt_s);

  // The same for a source that is no skeleton's pose: trackers. `source` has
  // the spine and neck of the source model; `dt_s` > 0.
  void RetargetBody(const BodyPose& source, double dt_s);

  // The same with contacts that are known.
  void RetargetBody(const BodyPose& source, const FootContacts& contacts,
                    double source_floor_m, double dt_s);

  // Parts of the method, for planning whole clips: where feet and toes would be
  // without planting, and a frame whose feet are given.
  struct CopiedFeet {
    std::array<FootPose, 2> feet;
    std::array<Eigen::Quaterniond, 2> toes;
  };
  CopiedFeet CopyFeet(const BodyPose& source, double source_floor_m,
                      double dt_s);
  void RetargetBody(const BodyPose& source, const FootContacts& contacts,
                    double source_floor_m, const CopiedFeet& planned,
                    double dt_s);

  // Of the last frame.
  const Eigen::VectorXd& positions() const { return positions_; }
  const RetargetReport& report() const { return report_; }

  // Forgets what was before: the next frame is a first one.
  void Reset();

  // What the next frame depends on beside positions(). Given to a retargeter of
  // the same models and options with the same positions (checked), the frames
  // after it are the same bit by bit, on the same instruction set. While
  // reading stops at a number that is wrong, the rest is of no use: see
  // StateNumbers.
  void Exchange(StateNumbers& state);
  void SetPositions(const ConstVectorView& positions) {
    positions_ = positions;
  }

  const Ground& ground() const { return *ground_; }
  const BodyModel& source() const { return *source_; }
  const BodyModel& target() const { return *target_; }

 private:
  Retargeter(std::shared_ptr<const BodyModel> source,
             std::shared_ptr<const BodyModel> target,
             const RetargetOptions& options, LimitKeeper limits);

  // Where the ankle would be if feet were not planted.
  FootPose FootGoal(const BodyPose& source, int side) const;
  Eigen::Quaterniond ToeGoal(const FootPose& foot, int side) const;
  // Fills goals_.feet and goals_.toes.
  void AimFeet(const BodyPose& source, double dt_s);
  // What is left once the feet are aimed.
  void Finish(const BodyPose& source, double dt_s);
  void AimHands(const BodyPose& source);
  // Of the pose that is stored: joint limits may have moved it.
  void MeasureErrors();
  // Of the ground under the target: eased, so that the body does not jump up
  // stairs.
  double FollowGround(const BodyPose& source, double dt_s);

  std::shared_ptr<const BodyModel> source_;
  std::shared_ptr<const BodyModel> target_;
  RetargetOptions options_;
  std::shared_ptr<const Ground> ground_;
  BodyPose source_pose_;
  BodyPoseReader reader_;
  Eigen::VectorXd checked_;
  ContactDetector detector_;
  RotationTransfer transfer_;
  RigPose rig_;
  std::array<std::optional<FootPlanter>, 2> planters_;
  LimbPlacement placement_;
  LimitKeeper limits_;
  WorldTransforms limited_;
  bool has_feet_;
  double ground_m_ = 0;
  bool is_first_ = true;
  LimbGoals goals_;
  Eigen::VectorXd positions_;
  Eigen::VectorXd last_positions_;
  RetargetReport report_;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_RETARGETER_H_
