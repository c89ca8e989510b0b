// A skeleton compiled for forward kinematics at full speed: the frames of all
// joints and the axis of every degree of freedom, all that a Jacobian is made
// of.
//
// ForwardKinematics needs no compiling and gives quaternions, for a pose now
// and then; this is for poses by the million. Rotations are matrices, sines and
// cosines of all angles are taken in vector registers, and what follows is one
// parents-first pass (see kernel/forward_layout.h). About 6 ns a joint of one
// degree of freedom.
#ifndef GELENK_KINEMATICS_KINEMATIC_TREE_H_
#define GELENK_KINEMATICS_KINEMATIC_TREE_H_

#include <Eigen/Core>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/kinematics/kernel/forward_layout.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// One way in which the bodies beyond a joint can move. Degrees of freedom have
// one each, a joint that mimics another has one of its own. In the order of the
// joints, within one that of JointType's velocities.
struct MotionAxis {
  int joint;      // that moves
  int velocity;   // that drives it; of a mimic, that of the joint it follows
  bool rotation;  // about the axis through the joint's origin, else along it
  double multiplier;  // of that velocity: 1 but for mimics
};

// The result of KinematicTree::Evaluate, and its working memory. World frame,
// m. Reuse it: memory is taken only when the tree is larger than any before.
class KinematicFrames {
 public:
  using ConstRotation =
      Eigen::Map<const Eigen::Matrix3d, 0, Eigen::OuterStride<4>>;
  using ConstPoint = Eigen::Map<const Eigen::Vector3d>;

  // world_from_joint.
  ConstRotation rotation(int joint) const {
    return ConstRotation(frame(joint));
  }
  ConstPoint origin(int joint) const { return ConstPoint(frame(joint) + 12); }

 private:
  friend class KinematicTree;

  struct alignas(64) CacheLine {
    double numbers[8];
  };

  const double* numbers() const { return memory_[0].numbers; }
  const double* frame(int joint) const {
    return numbers() + kernel::kFrameSize * joint;
  }

  std::vector<CacheLine> memory_;
};

// Immutable, safe to use from any thread.
class KinematicTree {
 public:
  // `level` must be supported; see SupportedInstructionSets. Cost: linear in
  // the joints; keeps no reference to `skeleton`.
  explicit KinematicTree(const Skeleton& skeleton,
                         InstructionSet level = BestInstructionSet());

  int joint_count() const { return static_cast<int>(joints_.size()); }
  absl::Span<const MotionAxis> axes() const { return axes_; }

  // `positions` has size position_count. `world_from_skeleton` is where the
  // actor stands.
  void Evaluate(const ConstVectorView& positions,
                const RigidTransform& world_from_skeleton,
                KinematicFrames& frames) const;
  void Evaluate(const ConstVectorView& positions,
                KinematicFrames& frames) const {
    Evaluate(positions, RigidTransform(), frames);
  }

  // The direction of axes()[axis] at the pose that `frames` were evaluated at.
  KinematicFrames::ConstPoint WorldAxis(const KinematicFrames& frames,
                                        int axis) const {
    return KinematicFrames::ConstPoint(frames.numbers() + axis_places_[axis]);
  }

 private:
  friend class KinematicTreeBuilder;

  kernel::ForwardFunction evaluate_;
  std::vector<kernel::ForwardJoint> joints_;
  std::vector<kernel::ForwardAngles> angles_;
  std::vector<kernel::ForwardAxis> free_axes_;  // that are no frame's column
  std::vector<KinematicFrames::CacheLine> constants_;
  std::vector<MotionAxis> axes_;
  // Where in KinematicFrames each axis is: a column of a frame, or beyond all
  // frames one of free_axes_.
  std::vector<int> axis_places_;
};

}  // namespace gelenk

#endif  // GELENK_KINEMATICS_KINEMATIC_TREE_H_
