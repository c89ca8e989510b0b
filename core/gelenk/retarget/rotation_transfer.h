// The plain way to retarget: every bone is turned as the source's, and the root
// goes as far as the legs are longer. What feet and hands make of it, nobody
// asks; this is where Retargeter begins, and what it is compared with.
#ifndef GELENK_RETARGET_ROTATION_TRANSFER_H_
#define GELENK_RETARGET_ROTATION_TRANSFER_H_

#include <memory>
#include <optional>
#include <vector>

#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"
#include "gelenk/retarget/chain_profile.h"
#include "gelenk/retarget/rig_pose.h"

namespace gelenk {

class RotationTransfer {
 public:
  // `root_scale` is the way over the ground in the target for a way 1 in the
  // source; by the legs when unset.
  RotationTransfer(std::shared_ptr<const BodyModel> source,
                   std::shared_ptr<const BodyModel> target,
                   std::optional<double> root_scale = std::nullopt);

  // Turns and places `rig`, which is of the target. `source_floor_m` and
  // `target_floor_m` are the heights of the ground under the bodies. Allocates
  // nothing; cost: linear in the target's joints.
  void Apply(const BodyPose& source, double source_floor_m,
             double target_floor_m, RigPose& rig) const;

  // Way over the ground in the target for a way 1 in the source.
  double root_scale() const { return root_scale_; }

 private:
  struct RoleTurn {
    int joint;
    BodyRole role;
  };
  struct ChainTurn {
    int joint;
    ChainPlace place;
  };

  Eigen::Vector3d PelvisPlace(const BodyPose& source,
                              const Eigen::Quaterniond& pelvis,
                              double source_floor_m,
                              double target_floor_m) const;

  std::shared_ptr<const BodyModel> source_;
  std::shared_ptr<const BodyModel> target_;
  // Of heights: the length in the target of a length 1 in the source.
  double scale_;
  double root_scale_;
  double source_ankle_ = 0;
  double target_ankle_ = 0;
  // The middle between the target's thighs in the pelvis' joint frame.
  Eigen::Vector3d pelvis_from_hip_center_ = Eigen::Vector3d::Zero();
  std::vector<RoleTurn> roles_;
  std::vector<ChainTurn> spine_;
  std::vector<ChainTurn> neck_;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_ROTATION_TRANSFER_H_
