// A pose without its rig: where the parts of a body are and how they are
// turned.
//
// Canonical coordinates (see body_model.h). Made of a skeleton's pose, or of
// trackers. What the map lacks has the rotation and place of what it hangs on.
#ifndef GELENK_RETARGET_BODY_POSE_H_
#define GELENK_RETARGET_BODY_POSE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "gelenk/contact/foot_points.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_role.h"

namespace gelenk {

struct BodyPose {
  // By role: identity in the canonical T-pose.
  std::array<Eigen::Quaterniond, kBodyRoleCount> rotations;
  std::array<Eigen::Vector3d, kBodyRoleCount> positions;
  // Of the joints of map.spine and map.neck.
  std::vector<Eigen::Quaterniond> spine;
  std::vector<Eigen::Quaterniond> neck;
  FootPoints foot_points;
  // The middle between the thighs.
  Eigen::Vector3d hip_center = Eigen::Vector3d::Zero();

  const Eigen::Quaterniond& rotation(BodyRole role) const {
    return rotations[IndexOf(role)];
  }
  const Eigen::Vector3d& position(BodyRole role) const {
    return positions[IndexOf(role)];
  }
};

// Allocates only when `pose` comes from another body. Cost: linear in the
// roles.
void ReadBodyPose(const BodyModel& model,
                  const WorldTransforms& world_from_joints, BodyPose& pose);

// Forward kinematics, then ReadBodyPose.
class BodyPoseReader {
 public:
  explicit BodyPoseReader(std::shared_ptr<const BodyModel> model)
      : model_(std::move(model)),
        world_from_joints_(model_->skeleton->joint_count()) {}

  void Read(const ConstVectorView& positions, BodyPose& pose);

 private:
  std::shared_ptr<const BodyModel> model_;
  WorldTransforms world_from_joints_;
};

// Fills what `pose` lacks in the order parent to child; `has` by role.
void FillMissingRoles(const std::array<bool, kBodyRoleCount>& has,
                      BodyPose& pose);

}  // namespace gelenk

#endif  // GELENK_RETARGET_BODY_POSE_H_
