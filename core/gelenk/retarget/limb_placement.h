// Gives a copied pose its goals: feet where they are planted, hands where the
// source has them, the pelvis between.
#ifndef GELENK_RETARGET_LIMB_PLACEMENT_H_
#define GELENK_RETARGET_LIMB_PLACEMENT_H_

#include <array>
#include <memory>
#include <optional>

#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/foot_planter.h"
#include "gelenk/retarget/limb_bend.h"
#include "gelenk/retarget/pelvis_shift.h"
#include "gelenk/retarget/rig_pose.h"

namespace gelenk {

// By side, canonical; what is unset stays as copied.
struct LimbGoals {
  std::array<std::optional<FootPose>, 2> feet;
  std::array<Eigen::Quaterniond, 2> toes = {Eigen::Quaterniond::Identity(),
                                            Eigen::Quaterniond::Identity()};
  std::array<std::optional<Eigen::Vector3d>, 2> hands;
};

class LimbPlacement {
 public:
  explicit LimbPlacement(std::shared_ptr<const BodyModel> target);

  void Reset();
  void Exchange(StateNumbers& state);

  // Moves `rig`, which has the copied pose, to the goals: first the pelvis, so
  // that the legs reach, then legs and arms. Feet, toes and hands keep their
  // orientations. Returns the way of the pelvis. Allocates nothing.
  Eigen::Vector3d Apply(const LimbGoals& goals, double dt_s, RigPose& rig);

 private:
  void PlaceLimb(BodyRole upper, BodyRole middle, BodyRole end,
                 const Eigen::Vector3d& goal, double dt_s, LimbBend& bend,
                 RigPose& rig);

  std::shared_ptr<const BodyModel> target_;
  PelvisShift pelvis_shift_;
  std::array<std::optional<LimbBend>, 2> legs_;
  std::array<std::optional<LimbBend>, 2> arms_;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_LIMB_PLACEMENT_H_
