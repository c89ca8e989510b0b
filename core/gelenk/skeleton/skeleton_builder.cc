#include "gelenk/skeleton/skeleton_builder.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/joint_order.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

using JointById = absl::flat_hash_map<absl::string_view, const Joint*>;

bool IsScalar(JointType type) {
  return type == JointType::kRevolute || type == JointType::kPrismatic;
}

// Numbers of q that `joint` owns.
int OwnedCount(const Joint& joint) {
  return joint.mimic ? 0 : PositionCount(joint.type);
}

void CheckPlanar(absl::string_view field, const Joint& joint,
                 Violations& violations) {
  constexpr double kInPlane = 1e-9;
  if (joint.type == JointType::kSpherical || joint.type == JointType::kFree) {
    violations.Add(absl::StrCat(field, ".type"),
                   absl::StrCat("a ", JointTypeName(joint.type),
                                " joint leaves the plane"));
  }
  const bool along_z = std::abs(std::abs(joint.axis.z()) - 1) < kInPlane;
  const bool in_plane = std::abs(joint.axis.z()) < kInPlane;
  const bool fits = joint.type == JointType::kPrismatic ? in_plane : along_z;
  if (NeedsAxis(joint.type) && !fits) {
    violations.Add(absl::StrCat(field, ".axis"), "leaves the XY plane");
  }
  const RigidTransform& offset = joint.parent_from_joint;
  if (std::abs(offset.translation.z()) > kInPlane ||
      std::abs(offset.rotation.x()) > kInPlane ||
      std::abs(offset.rotation.y()) > kInPlane) {
    violations.Add(absl::StrCat(field, ".parent_from_joint"),
                   "leaves the XY plane");
  }
}

// What a mimic follows must own its number.
void CheckFollowed(absl::string_view field, const Mimic& mimic,
                   const JointById& joint_by_id, Violations& violations) {
  const auto found = joint_by_id.find(mimic.joint_id);
  if (found == joint_by_id.end()) {
    violations.Add(field, absl::StrCat("no joint ", QuotedId(mimic.joint_id)));
  } else if (found->second->mimic || !IsScalar(found->second->type)) {
    violations.Add(field,
                   absl::StrCat("joint ", QuotedId(mimic.joint_id),
                                " is no revolute or prismatic joint of its "
                                "own"));
  }
}

void CheckAndNormalize(std::vector<EndEffector>& effectors,
                       const JointById& joint_by_id, Violations& violations) {
  absl::flat_hash_set<absl::string_view> ids;
  for (size_t i = 0; i < effectors.size(); ++i) {
    EndEffector& effector = effectors[i];
    const std::string field = absl::StrCat("end_effectors[", i, "]");
    CheckId(absl::StrCat(field, ".end_effector_id"), effector.id, violations);
    CheckAndNormalize(absl::StrCat(field, ".joint_from_end_effector"),
                      effector.joint_from_end_effector, violations);
    if (!ids.insert(effector.id).second) {
      violations.Add(absl::StrCat(field, ".end_effector_id"),
                     absl::StrCat("duplicate ", QuotedId(effector.id)));
    }
    if (!joint_by_id.contains(effector.joint_id)) {
      violations.Add(absl::StrCat(field, ".joint_id"),
                     absl::StrCat("no joint ", QuotedId(effector.joint_id)));
    }
  }
}

// `positions` in the order of `joints`.
void CheckAndNormalize(const std::vector<Joint>& joints,
                       Eigen::VectorXd& positions, Violations& violations) {
  int count = 0;
  for (const Joint& joint : joints) count += OwnedCount(joint);
  if (positions.size() != count) {
    violations.Add(
        "rest_pose.positions",
        absl::StrFormat("want %d numbers, got %d", count, positions.size()));
    return;
  }
  Violations wrong;
  int offset = 0;
  for (const Joint& joint : joints) {
    if (joint.mimic) continue;
    CheckJointPositions(joint.type, offset, positions, wrong);
    offset += OwnedCount(joint);
  }
  violations.AddStatus("rest_pose", wrong.ToStatus());
}

}  // namespace

SkeletonBuilder& SkeletonBuilder::AddJoint(Joint joint) {
  joints_.push_back(std::move(joint));
  return *this;
}

SkeletonBuilder& SkeletonBuilder::AddEndEffector(EndEffector end_effector) {
  end_effectors_.push_back(std::move(end_effector));
  return *this;
}

SkeletonBuilder& SkeletonBuilder::SetUp(const Eigen::Vector3d& up) {
  up_ = up;
  return *this;
}

SkeletonBuilder& SkeletonBuilder::SetPlanar(bool planar) {
  planar_ = planar;
  return *this;
}

SkeletonBuilder& SkeletonBuilder::SetRestPositions(Eigen::VectorXd positions) {
  rest_positions_ = std::move(positions);
  return *this;
}

SkeletonBuilder& SkeletonBuilder::SetBounds(const SkeletonBounds& bounds) {
  bounds_ = bounds;
  return *this;
}

absl::Status SkeletonBuilder::CheckCounts() const {
  Violations violations;
  const auto check = [&violations](absl::string_view field, size_t count,
                                   int most) {
    if (count <= static_cast<size_t>(most)) return;
    violations.Add(field,
                   absl::StrFormat("want at most %d, got %d", most, count));
  };
  check("joints", joints_.size(), bounds_.max_joints);
  check("end_effectors", end_effectors_.size(), bounds_.max_end_effectors);
  return violations.ToStatus();
}

void SkeletonBuilder::PlaceJoints(const std::vector<int>& order,
                                  std::vector<Joint>& joints,
                                  Skeleton& skeleton) const {
  absl::flat_hash_map<absl::string_view, int> index_of;
  for (size_t i = 0; i < order.size(); ++i) {
    index_of[joints_[order[i]].id] = static_cast<int>(i);
  }
  for (int from : order) {
    Joint& joint = joints[from];
    JointSpan span;
    if (!joint.parent_id.empty()) span.parent = index_of.at(joint.parent_id);
    if (joint.mimic) span.mimicked = index_of.at(joint.mimic->joint_id);
    if (OwnedCount(joint) > 0) {
      span.position_offset = skeleton.position_count_;
      span.velocity_offset = skeleton.velocity_count_;
      if (joint.type == JointType::kSpherical) {
        span.quaternion_offset = span.position_offset;
      } else if (joint.type == JointType::kFree) {
        span.quaternion_offset = span.position_offset + 3;
      }
      skeleton.position_count_ += PositionCount(joint.type);
      skeleton.velocity_count_ += VelocityCount(joint.type);
    }
    skeleton.joints_.push_back(std::move(joint));
    skeleton.spans_.push_back(span);
  }
  skeleton.position_bounds_ = BoundPositions(skeleton.joints_, skeleton.spans_,
                                             skeleton.position_count_);
}

void SkeletonBuilder::PlaceRestPositions(const std::vector<int>& order,
                                         const Eigen::VectorXd& given,
                                         Skeleton& skeleton) const {
  skeleton.rest_positions_ = NeutralPositions(skeleton);
  if (given.size() == 0) return;
  std::vector<int> given_offset;
  int next = 0;
  for (const Joint& joint : joints_) {
    given_offset.push_back(next);
    next += OwnedCount(joint);
  }
  for (size_t i = 0; i < order.size(); ++i) {
    const int count = OwnedCount(skeleton.joints_[i]);
    if (count == 0) continue;
    skeleton.rest_positions_.segment(skeleton.spans_[i].position_offset,
                                     count) =
        given.segment(given_offset[order[i]], count);
  }
}

absl::StatusOr<std::shared_ptr<const Skeleton>> SkeletonBuilder::Build() const {
  // First, so that nothing below is larger than allowed.
  if (absl::Status status = CheckCounts(); !status.ok()) return status;
  Violations violations;
  JointById joint_by_id;
  for (const Joint& joint : joints_) joint_by_id.emplace(joint.id, &joint);
  std::vector<Joint> joints = joints_;
  for (size_t i = 0; i < joints.size(); ++i) {
    const std::string field = absl::StrCat("joints[", i, "]");
    CheckAndNormalize(field, joints[i], violations);
    if (planar_) CheckPlanar(field, joints[i], violations);
    if (joints[i].mimic) {
      CheckFollowed(absl::StrCat(field, ".mimic.joint_id"), *joints[i].mimic,
                    joint_by_id, violations);
    }
  }
  const std::vector<int> order =
      OrderParentsFirst(joints_, bounds_.max_depth, violations);
  std::vector<EndEffector> end_effectors = end_effectors_;
  CheckAndNormalize(end_effectors, joint_by_id, violations);
  if (!up_.allFinite() || up_.norm() < 1e-9) {
    violations.Add("up", absl::StrCat("want a direction, got ", Text(up_)));
  }
  Eigen::VectorXd rest_positions = rest_positions_;
  if (rest_positions.size() > 0) {
    CheckAndNormalize(joints_, rest_positions, violations);
  }
  if (!violations.empty()) return violations.ToStatus();

  std::shared_ptr<Skeleton> skeleton(new Skeleton());
  PlaceJoints(order, joints, *skeleton);
  PlaceRestPositions(order, rest_positions, *skeleton);
  skeleton->end_effectors_ = std::move(end_effectors);
  skeleton->up_ = up_.normalized();
  return skeleton;
}

}  // namespace gelenk
