// What must hold of every skeleton that an importer makes.
#ifndef GELENK_TESTS_FUZZ_IMPORTED_SKELETON_H_
#define GELENK_TESTS_FUZZ_IMPORTED_SKELETON_H_

#include <algorithm>

#include "gelenk/formats/unique_names.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"
#include "tests/fuzz/fuzz_check.h"

namespace gelenk {

// Names are ids in UTF-8 and everything is found by its own; the rest pose is
// inside the limits, and forward kinematics there are finite.
inline void CheckImported(const Skeleton& skeleton) {
  for (const Joint& joint : skeleton.joints()) {
    GELENK_FUZZ_CHECK(!joint.id.empty() && joint.id.size() <= kMaxIdBytes);
    GELENK_FUZZ_CHECK(PrintableUtf8(joint.id) == joint.id);
    GELENK_FUZZ_CHECK(skeleton.FindEffector(joint.id).has_value());
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    GELENK_FUZZ_CHECK(PrintableUtf8(effector.id) == effector.id);
    // It hides no joint.
    GELENK_FUZZ_CHECK(skeleton.FindJoint(effector.id) < 0);
  }
  Eigen::VectorXd rest = skeleton.rest_positions();
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, rest, world_from_joints);
  for (const RigidTransform& frame : world_from_joints) {
    GELENK_FUZZ_CHECK(frame.translation.allFinite());
    GELENK_FUZZ_CHECK(frame.rotation.coeffs().allFinite());
  }
  // Limits of a joint and of its mimics that contradict each other leave the
  // mimic's broken.
  const double excess = ClampToLimits(skeleton, rest);
  const double size =
      std::max(1.0, rest.size() == 0 ? 0.0 : rest.cwiseAbs().maxCoeff());
  GELENK_FUZZ_CHECK(excess <= 1e-9 * size);
}

}  // namespace gelenk

#endif  // GELENK_TESTS_FUZZ_IMPORTED_SKELETON_H_
