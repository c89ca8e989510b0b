// An immutable articulated structure: joints in flat arrays, parents first.
//
// Built by SkeletonBuilder only; shared as shared_ptr<const Skeleton>. Safe to
// read from any thread.
#ifndef GELENK_SKELETON_SKELETON_H_
#define GELENK_SKELETON_SKELETON_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/skeleton/joint.h"
#include "gelenk/skeleton/position_bounds.h"

namespace gelenk {

// Where a joint's numbers live. Never index q by a joint's index.
struct JointSpan {
  int parent = -1;             // index of the parent joint, -1 for the root
  int position_offset = -1;    // first number in q, -1 for none
  int velocity_offset = -1;    // first number in a velocity, -1 for none
  int quaternion_offset = -1;  // first number of its quaternion in q, if any
  int mimicked = -1;           // index of the joint that a mimic joint follows
};

// What a goal can be tied to: a frame that rides on a joint.
struct EffectorFrame {
  int joint = -1;
  RigidTransform joint_from_effector;
};

class Skeleton {
 public:
  int joint_count() const { return static_cast<int>(joints_.size()); }
  int position_count() const { return position_count_; }
  int velocity_count() const { return velocity_count_; }

  const Joint& joint(int index) const { return joints_[index]; }
  const JointSpan& span(int index) const { return spans_[index]; }
  absl::Span<const Joint> joints() const { return joints_; }
  absl::Span<const EndEffector> end_effectors() const { return end_effectors_; }

  // -1 when there is none. Cost: linear in the joints.
  int FindJoint(absl::string_view id) const;

  // An end effector by its id, or the origin of the joint of that id.
  std::optional<EffectorFrame> FindEffector(absl::string_view id) const;

  // Unit, world frame.
  const Eigen::Vector3d& up() const { return up_; }

  // What people call neutral (a T-pose): all zeros and identities unless given.
  const Eigen::VectorXd& rest_positions() const { return rest_positions_; }

  // The range of each number of q by the limits of its joint and of those that
  // mimic it; infinite where there are none.
  const PositionBounds& position_bounds() const { return position_bounds_; }

  // Bytes that this skeleton holds, for quotas.
  size_t ByteSize() const;

 private:
  friend class SkeletonBuilder;
  Skeleton() = default;

  std::vector<Joint> joints_;
  std::vector<JointSpan> spans_;
  std::vector<EndEffector> end_effectors_;
  Eigen::VectorXd rest_positions_;
  PositionBounds position_bounds_;
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitY();
  int position_count_ = 0;
  int velocity_count_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_SKELETON_SKELETON_H_
