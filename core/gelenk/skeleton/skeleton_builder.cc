#include "gelenk/skeleton/skeleton_builder.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

std::string JointField(size_t index) {
  return absl::StrCat("joints[", index, "]");
}

std::string Quoted(absl::string_view id) {
  return absl::StrCat("\"", absl::CHexEscape(id), "\"");
}

void CheckPlanar(size_t index, const Joint& joint, Violations& violations) {
  constexpr double kInPlane = 1e-9;
  const std::string field = JointField(index);
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

// Fills the joints a mimic follows; those must own a number.
void LinkMimics(const std::vector<Joint>& joints,
                const absl::flat_hash_map<std::string, int>& index_of,
                std::vector<JointSpan>& spans, Violations& violations) {
  for (size_t i = 0; i < joints.size(); ++i) {
    if (!joints[i].mimic) continue;
    const std::string& id = joints[i].mimic->joint_id;
    const std::string field =
        absl::StrCat("joint ", Quoted(joints[i].id), ".mimic.joint_id");
    const auto found = index_of.find(id);
    if (found == index_of.end()) {
      violations.Add(field, absl::StrCat("no joint ", Quoted(id)));
      continue;
    }
    const Joint& followed = joints[found->second];
    if (followed.mimic || (followed.type != JointType::kRevolute &&
                           followed.type != JointType::kPrismatic)) {
      violations.Add(field, absl::StrCat("joint ", Quoted(id),
                                         " is no revolute or prismatic joint "
                                         "of its own"));
      continue;
    }
    spans[i].mimicked = found->second;
  }
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

std::vector<int> SkeletonBuilder::OrderParentsFirst(
    Violations& violations) const {
  absl::flat_hash_map<absl::string_view, int> index_of;
  for (size_t i = 0; i < joints_.size(); ++i) {
    if (!index_of.emplace(joints_[i].id, i).second) {
      violations.Add(absl::StrCat(JointField(i), ".joint_id"),
                     absl::StrCat("duplicate ", Quoted(joints_[i].id)));
    }
  }
  std::vector<int> parents(joints_.size(), -1);
  int roots = 0;
  for (size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].parent_id.empty()) {
      ++roots;
      continue;
    }
    const auto found = index_of.find(joints_[i].parent_id);
    if (found == index_of.end()) {
      violations.Add(absl::StrCat(JointField(i), ".parent_joint_id"),
                     absl::StrCat("no joint ", Quoted(joints_[i].parent_id)));
    } else {
      parents[i] = found->second;
    }
  }
  if (roots != 1) {
    violations.Add("joints", absl::StrFormat("want one root, got %d", roots));
  }
  // Each joint is placed behind its ancestors; a walk that meets itself is a
  // cycle.
  enum class Mark : char { kNew, kOpen, kDone };
  std::vector<Mark> marks(joints_.size(), Mark::kNew);
  std::vector<int> depths(joints_.size(), 0);
  std::vector<int> order;
  std::vector<int> walk;
  for (size_t start = 0; start < joints_.size(); ++start) {
    walk.clear();
    int at = static_cast<int>(start);
    while (at >= 0 && marks[at] == Mark::kNew) {
      marks[at] = Mark::kOpen;
      walk.push_back(at);
      at = parents[at];
    }
    if (at >= 0 && marks[at] == Mark::kOpen) {
      violations.Add(absl::StrCat(JointField(at), ".parent_joint_id"),
                     absl::StrCat("joint ", Quoted(joints_[at].id),
                                  " is its own ancestor"));
    }
    for (auto it = walk.rbegin(); it != walk.rend(); ++it) {
      marks[*it] = Mark::kDone;
      depths[*it] = parents[*it] < 0 ? 1 : depths[parents[*it]] + 1;
      if (depths[*it] == bounds_.max_depth + 1) {
        violations.Add(
            absl::StrCat(JointField(*it), ".parent_joint_id"),
            absl::StrFormat("deeper than %d joints", bounds_.max_depth));
      }
      order.push_back(*it);
    }
  }
  return order;
}

absl::StatusOr<std::shared_ptr<const Skeleton>> SkeletonBuilder::Build() const {
  Violations violations;
  if (joints_.size() > static_cast<size_t>(bounds_.max_joints)) {
    violations.Add(
        "joints", absl::StrFormat("want at most %d, got %d", bounds_.max_joints,
                                  joints_.size()));
    return violations.ToStatus();
  }
  if (end_effectors_.size() > static_cast<size_t>(bounds_.max_end_effectors)) {
    violations.Add("end_effectors", absl::StrFormat("want at most %d, got %d",
                                                    bounds_.max_end_effectors,
                                                    end_effectors_.size()));
    return violations.ToStatus();
  }
  std::vector<Joint> checked = joints_;
  for (size_t i = 0; i < checked.size(); ++i) {
    CheckAndNormalize(JointField(i), checked[i], violations);
    if (planar_) CheckPlanar(i, checked[i], violations);
  }
  const std::vector<int> order = OrderParentsFirst(violations);
  if (!violations.empty()) return violations.ToStatus();

  std::shared_ptr<Skeleton> skeleton(new Skeleton());
  absl::flat_hash_map<std::string, int> index_of;
  for (int from : order) {
    Joint& joint = checked[from];
    JointSpan span;
    if (!joint.parent_id.empty()) span.parent = index_of.at(joint.parent_id);
    index_of[joint.id] = skeleton->joint_count();
    if (!joint.mimic && joint.type != JointType::kFixed) {
      span.position_offset = skeleton->position_count_;
      span.velocity_offset = skeleton->velocity_count_;
      skeleton->position_count_ += PositionCount(joint.type);
      skeleton->velocity_count_ += VelocityCount(joint.type);
    }
    skeleton->joints_.push_back(std::move(joint));
    skeleton->spans_.push_back(span);
  }
  LinkMimics(skeleton->joints_, index_of, skeleton->spans_, violations);

  absl::flat_hash_set<absl::string_view> effector_ids;
  for (size_t i = 0; i < end_effectors_.size(); ++i) {
    EndEffector effector = end_effectors_[i];
    const std::string field = absl::StrCat("end_effectors[", i, "]");
    CheckId(absl::StrCat(field, ".end_effector_id"), effector.id, violations);
    CheckAndNormalize(absl::StrCat(field, ".joint_from_end_effector"),
                      effector.joint_from_end_effector, violations);
    if (!effector_ids.insert(end_effectors_[i].id).second) {
      violations.Add(absl::StrCat(field, ".end_effector_id"),
                     absl::StrCat("duplicate ", Quoted(effector.id)));
    }
    if (!index_of.contains(effector.joint_id)) {
      violations.Add(absl::StrCat(field, ".joint_id"),
                     absl::StrCat("no joint ", Quoted(effector.joint_id)));
    }
    skeleton->end_effectors_.push_back(std::move(effector));
  }

  if (!up_.allFinite() || up_.norm() < 1e-9) {
    violations.Add("up", "want a direction");
  } else {
    skeleton->up_ = up_.normalized();
  }
  if (!violations.empty()) return violations.ToStatus();

  skeleton->rest_positions_ = NeutralPositions(*skeleton);
  if (rest_positions_.size() > 0) {
    // Given in the order of adding; stored in the order of the skeleton.
    std::vector<int> given_offset(joints_.size(), 0);
    int given = 0;
    for (size_t i = 0; i < joints_.size(); ++i) {
      given_offset[i] = given;
      if (!joints_[i].mimic) given += PositionCount(joints_[i].type);
    }
    if (given != rest_positions_.size()) {
      violations.Add("rest_pose.positions",
                     absl::StrFormat("want %d numbers, got %d", given,
                                     rest_positions_.size()));
      return violations.ToStatus();
    }
    for (size_t i = 0; i < order.size(); ++i) {
      const int offset = skeleton->spans_[i].position_offset;
      if (offset < 0) continue;
      const int count = PositionCount(skeleton->joints_[i].type);
      skeleton->rest_positions_.segment(offset, count) =
          rest_positions_.segment(given_offset[order[i]], count);
    }
    violations.AddStatus("rest_pose",
                         CheckPositions(*skeleton, skeleton->rest_positions_));
    if (!violations.empty()) return violations.ToStatus();
  }
  return skeleton;
}

}  // namespace gelenk
