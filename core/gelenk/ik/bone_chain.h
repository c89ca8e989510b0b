// A serial chain as points: bones of fixed length between pivots that can point
// their bone anywhere, in space or in a plane. What FABRIK works on.
//
// A pivot is a spherical joint, a *gimbal* (three revolute joints whose axes
// meet in it, each perpendicular to the next) or, when all axes of the chain
// are parallel, a *hinge* (one revolute joint).
//
// Immutable, safe to use from any thread. Units m, rad; points in world frame.
// Cost of all that goes along the chain: linear in its bones.
#ifndef GELENK_IK_BONE_CHAIN_H_
#define GELENK_IK_BONE_CHAIN_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/math/rigid_transform.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// A pose of such a chain.
struct BonePose {
  // The pivots and the tip, one more than bones. Of a chain in a plane all are
  // in the plane of the first pivot.
  std::vector<Eigen::Vector3d> points;
  // What its joints turn each bone by.
  std::vector<Eigen::Matrix3d> turns;
};

class BoneChain {
 public:
  // INVALID_ARGUMENT saying why, with the joint's name: the tasks are not one
  // position, or the joint is part of no pivot, mimics another or has limits. A
  // range of a whole turn or more is no limit. `joints_of_nodes` are the
  // skeleton's joints behind the nodes of `tree`.
  static absl::StatusOr<BoneChain> Of(const Skeleton& skeleton,
                                      const kernel::TreeLayout& tree,
                                      absl::Span<const int> joints_of_nodes);

  int bone_count() const { return static_cast<int>(bones_.size()); }
  absl::Span<const double> lengths() const { return lengths_; }
  // All bones together, m.
  double total_length() const { return longest_reach_m_; }

  // Allocates only when the pose was smaller before.
  void ComputePose(const ConstVectorView& positions,
                   const RigidTransform& world_from_skeleton,
                   BonePose& pose) const;

  // Where the last point is to be for the tip to come as near to `world_target`
  // as the plane allows; in space that is the target.
  Eigen::Vector3d LastPointFor(const RigidTransform& world_from_skeleton,
                               const Eigen::Vector3d& world_target) const;

  // A unit vector perpendicular to `way`, in the plane if there is one.
  Eigen::Vector3d AnyAcross(const RigidTransform& world_from_skeleton,
                            const Eigen::Vector3d& way) const;

  // Whether the last point can be at `last` and about it.
  bool Reaches(const RigidTransform& world_from_skeleton,
               const Eigen::Vector3d& last) const;

  // Lays the points out along the line to `last`, which is out of reach, as
  // near to it as can be.
  void ReachOut(const Eigen::Vector3d& last, BonePose& pose) const;

  // Turns each joint of `positions`, which `pose` was computed from, by as
  // little as makes its bone point along the points as they are now; angles
  // stay within half a turn of what they were. Returns the tip, world.
  Eigen::Vector3d Follow(const BonePose& pose,
                         const RigidTransform& world_from_skeleton,
                         VectorView positions) const;

  size_t ByteSize() const {
    return bones_.capacity() * sizeof(Bone) +
           lengths_.capacity() * sizeof(double);
  }

 private:
  friend class BoneChainBuilder;

  enum class PivotType { kSpherical, kGimbal, kHinge };

  struct Bone {
    PivotType type;
    // Unit, in the frame of the pivot's last joint, turned as in TreeLayout.
    Eigen::Vector3d direction;
    // What does not move before each joint: the frame of the bone before, or of
    // the skeleton, from the first joint's at rest; of a gimbal also the frame
    // of each joint from the next one's.
    Eigen::Matrix3d rests[3];
    // Of a gimbal: the second joint's angle at which the third's axis is as
    // near to the first's as it gets, which is along it.
    double lock_angle;
    // Where q has its joints' numbers.
    int positions[3];
    // Of a hinge or gimbal.
    double lower[3];
    double upper[3];
  };

  BoneChain() = default;
  static Eigen::Matrix3d TurnOf(const Bone& bone,
                                const ConstVectorView& positions);
  static void TurnHinge(const Bone& bone, double angle, VectorView positions);
  static void TurnGimbal(const Bone& bone, const Eigen::Matrix3d& turn,
                         VectorView positions);

  std::vector<Bone> bones_;
  std::vector<double> lengths_;
  // How far the last point can be from the first; and where it is when the
  // longest bone points one way and all others back: if that is not negative,
  // it comes no nearer.
  double longest_reach_m_ = 0;
  double folded_reach_m_ = 0;
  Eigen::Vector3d skeleton_origin_;  // of the first pivot
  bool is_planar_ = false;
  Eigen::Vector3d skeleton_normal_;  // of the plane
  double height_m_ = 0;              // of the tip above it
};

}  // namespace gelenk

#endif  // GELENK_IK_BONE_CHAIN_H_
