// A pose of a rig in canonical coordinates, and the way back to its numbers.
//
// Joints are given orientations; their places follow from the bones. Joints
// that nobody turns keep their place in the parent as in the reference pose.
// Joints with a role turn as if they were balls; what single axes can do of it,
// LimitKeeper finds.
#ifndef GELENK_RETARGET_RIG_POSE_H_
#define GELENK_RETARGET_RIG_POSE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class RigPose {
 public:
  explicit RigPose(std::shared_ptr<const BodyModel> model);

  const BodyModel& model() const { return *model_; }

  // Whether the pelvis can go anywhere; false for robots with a fixed base.
  bool CanTravel() const { return carrier_ >= 0; }

  // Canonical. Orientations of joints that are set count as wanted, see
  // Follow.
  void SetWanted(int joint, const Eigen::Quaterniond& orientation);
  void SetPelvis(const Eigen::Vector3d& place) { pelvis_place_ = place; }

  const Eigen::Quaterniond& orientation(int joint) const {
    return orientations_[joint];
  }
  const Eigen::Vector3d& place(int joint) const { return places_[joint]; }
  const Eigen::Quaterniond& orientation(BodyRole role) const {
    return orientations_[model_->map.joint(role)];
  }
  const Eigen::Vector3d& place(BodyRole role) const {
    return places_[model_->map.joint(role)];
  }

  // Orients the joints that nobody has set and places all. Allocates nothing;
  // cost: linear in the joints.
  void Follow();

  // Moves everything without turning it.
  void Shift(const Eigen::Vector3d& way);

  // The numbers of q. `positions` has the size of the skeleton's.
  void Store(VectorView positions) const;

  // The anatomical body, as ReadBodyPose has it of the same pose.
  void ReadBody(BodyPose& pose) const;

 private:
  std::shared_ptr<const BodyModel> model_;
  std::vector<Eigen::Quaterniond> orientations_;
  std::vector<Eigen::Vector3d> places_;
  std::vector<char> wanted_;
  // Joints above the pelvis: they stand as in the reference, moved as a whole.
  std::vector<char> above_;
  std::vector<Eigen::Vector3d> above_from_pelvis_;
  Eigen::Vector3d pelvis_place_ = Eigen::Vector3d::Zero();
  int pelvis_ = -1;
  // The free joint at or above the pelvis that carries the body; -1 for none.
  int carrier_ = -1;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_RIG_POSE_H_
