// The pose in which the bones of a skeleton are compared with those of another:
// a standing body, its arms anywhere from a T over an A to straight down.
//
// The rest pose where it is one. Often it is not (all bones along X, lying on
// the floor); then the frame of a clip that comes nearest.
#ifndef GELENK_RETARGET_REFERENCE_POSE_H_
#define GELENK_RETARGET_REFERENCE_POSE_H_

#include <Eigen/Core>
#include <optional>

#include "absl/status/statusor.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/retarget/clip_view.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct ReferencePose {
  Eigen::VectorXd positions;
  // World, unit, perpendicular.
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  Eigen::Vector3d left = Eigen::Vector3d::UnitX();
  // 1 is perfect, 0 and less not of a standing body.
  double score = 0;
  // -1 for the rest pose.
  int frame = -1;

  bool IsRestPose() const { return frame < 0; }
};

// `up` is taken as the axis nearest to the way from the feet to the head when
// it is not given. Cost: linear in the joints.
ReferencePose ScorePose(const Skeleton& skeleton, const JointMap& map,
                        const Eigen::VectorXd& positions,
                        const std::optional<Eigen::Vector3d>& up);

// The rest pose when it scores above 0 or there is no clip; else the best of at
// most 400 frames. Cost: linear in both.
ReferencePose FindReferencePose(const Skeleton& skeleton, const JointMap& map,
                                const ClipView* clip);

}  // namespace gelenk

#endif  // GELENK_RETARGET_REFERENCE_POSE_H_
