#include "gelenk/skin/skin_link.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

// Joints that are nearer to each other are at one place.
constexpr double kShortestLinkM = 1e-6;
// A joint that turns but has nothing beyond it carries what is left of the
// limb: this much of the link before it.
constexpr double kBareEnd = 0.5;
// Without a link before it, that much.
constexpr double kBareRootM = 0.1;

bool Turns(JointType type) {
  return type != JointType::kFixed && type != JointType::kPrismatic;
}

class LinkDerivation {
 public:
  LinkDerivation(const Skeleton& skeleton, const SkinLinkOptions& options)
      : skeleton_(skeleton), options_(options) {}

  absl::StatusOr<std::vector<SkinLink>> Run() {
    Check();
    if (absl::Status status = violations_.ToStatus(); !status.ok()) {
      return status;
    }
    const int joints = skeleton_.joint_count();
    children_.resize(joints);
    subtree_.assign(joints, 1);
    link_of_.assign(joints, -1);
    for (int i = joints - 1; i > 0; --i) {
      subtree_[skeleton_.span(i).parent] += subtree_[i];
    }
    for (int i = 1; i < joints; ++i) {
      children_[skeleton_.span(i).parent].push_back(i);
    }
    for (int i = 0; i < joints; ++i) AddLink(i);
    Continue();
    if (links_.empty()) {
      return absl::InvalidArgumentError(
          "skeleton: no joint has anything beyond it, so there are no links");
    }
    if (static_cast<int>(links_.size()) > kMaxSkinLinks) {
      return absl::InvalidArgumentError(absl::StrCat(
          "skeleton: ", links_.size(), " links, at most ", kMaxSkinLinks));
    }
    return std::move(links_);
  }

 private:
  void Check() {
    Eigen::VectorXd rest = RestPositionsOf(skeleton_, options_);
    violations_.AddStatus("rest", CheckPositions(skeleton_, rest));
    if (!(options_.slenderness > 0 && options_.slenderness <= 10)) {
      violations_.Add(
          "slenderness",
          absl::StrCat("want a number in (0, 10], got ", options_.slenderness));
    }
    override_of_.assign(skeleton_.joint_count(), nullptr);
    for (size_t i = 0; i < options_.overrides.size(); ++i) {
      CheckOverride(options_.overrides[i], absl::StrCat("overrides[", i, "]"));
    }
    if (violations_.empty()) ForwardKinematics(skeleton_, rest, rest_);
  }

  void CheckOverride(const SkinLinkOverride& given, const std::string& field) {
    const int joint = CheckJoint(given.joint_id, field + ".joint_id");
    if (joint >= 0 && override_of_[joint] != nullptr) {
      violations_.Add(field + ".joint_id",
                      absl::StrCat("\"", given.joint_id, "\" is named twice"));
    }
    if (joint >= 0) override_of_[joint] = &given;
    if (given.length_m &&
        !(*given.length_m > kShortestLinkM && std::isfinite(*given.length_m))) {
      violations_.Add(
          field + ".length_m",
          absl::StrCat("want > ", kShortestLinkM, " m, got ", *given.length_m));
    }
    CheckDirection(given.direction, field + ".direction");
    CheckDirection(given.s_direction, field + ".s_direction");
    if (given.half_extents_m && !(given.half_extents_m->allFinite() &&
                                  given.half_extents_m->minCoeff() > 0)) {
      violations_.Add(
          field + ".half_extents_m",
          absl::StrCat("want two lengths > 0, got ", (*given.half_extents_m)[0],
                       ", ", (*given.half_extents_m)[1]));
    }
    if (given.continuation_joint_id && !given.continuation_joint_id->empty()) {
      CheckJoint(*given.continuation_joint_id,
                 field + ".continuation_joint_id");
    }
  }

  int CheckJoint(const std::string& id, const std::string& field) {
    const int joint = skeleton_.FindJoint(id);
    if (joint < 0) {
      violations_.Add(field, absl::StrCat("no joint \"", id, "\""));
    }
    return joint;
  }

  void CheckDirection(const std::optional<Vector3d>& direction,
                      const std::string& field) {
    if (direction && !(direction->allFinite() && direction->norm() > 0)) {
      violations_.Add(field, "want a finite vector that is not zero");
    }
  }

  // The joint whose link `joint` hangs from, by links that exist already.
  int ParentLink(int joint) const {
    for (int i = skeleton_.span(joint).parent; i >= 0;
         i = skeleton_.span(i).parent) {
      if (link_of_[i] >= 0) return link_of_[i];
    }
    return -1;
  }

  // In the joint's frame, at rest.
  Vector3d OffsetTo(int joint, int other) const {
    return rest_[joint].Inverse() * rest_[other].translation;
  }

  // True when a child at the same place carries the link instead.
  bool IsPassedOn(int joint) const {
    if (children_[joint].size() != 1) return false;
    const int child = children_[joint][0];
    const bool is_marker = children_[child].empty() &&
                           skeleton_.joint(child).type == JointType::kFixed &&
                           OffsetToEffector(child).norm() <= kShortestLinkM;
    return !is_marker && OffsetTo(joint, child).norm() <= kShortestLinkM;
  }

  // Unit, joint frame: where the link before points; zero at the root.
  Vector3d IncomingDirection(int joint, int parent) const {
    if (parent < 0) return Vector3d::Zero();
    const Vector3d world = WorldFromLink(parent).rotation * Vector3d::UnitX();
    return rest_[joint].rotation.conjugate() * world;
  }

  RigidTransform WorldFromLink(int link) const {
    return rest_[links_[link].joint] * links_[link].joint_from_link;
  }

  // The child that the link of `joint` leads to: the one straight on, or at
  // the root the one with most beyond it. -1 without any.
  int NextJoint(int joint, const Vector3d& incoming) const {
    int best = -1;
    double best_score = -std::numeric_limits<double>::infinity();
    for (int child : children_[joint]) {
      const Vector3d offset = OffsetTo(joint, child);
      if (offset.norm() <= kShortestLinkM) continue;
      const double score = incoming.isZero()
                               ? subtree_[child]
                               : offset.normalized().dot(incoming);
      if (score > best_score) best = child, best_score = score;
    }
    return best;
  }

  // To the farthest end effector; zero without any.
  Vector3d OffsetToEffector(int joint) const {
    Vector3d offset = Vector3d::Zero();
    for (const EndEffector& effector : skeleton_.end_effectors()) {
      if (effector.joint_id != skeleton_.joint(joint).id) continue;
      const Vector3d& to = effector.joint_from_end_effector.translation;
      if (to.norm() > offset.norm()) offset = to;
    }
    return offset;
  }

  // Where the link of `joint` ends, joint frame; zero for no link.
  Vector3d EndOffset(int joint, int parent, const Vector3d& incoming,
                     int* next) const {
    const SkinLinkOverride* given = override_of_[joint];
    *next = NextJoint(joint, incoming);
    if (given && given->continuation_joint_id) {
      const int wanted = skeleton_.FindJoint(*given->continuation_joint_id);
      *next = wanted >= 0 ? wanted : -1;
    }
    Vector3d offset = Vector3d::Zero();
    const Joint& described = skeleton_.joint(joint);
    if (*next >= 0) {
      offset = OffsetTo(joint, *next);
    } else if (OffsetToEffector(joint).norm() > kShortestLinkM) {
      offset = OffsetToEffector(joint);
    } else if (described.link_length_m > 0) {
      offset = described.link_length_m * described.link_direction;
    } else if (Turns(described.type) && children_[joint].empty()) {
      offset = parent < 0
                   ? Vector3d(kBareRootM * Vector3d::UnitX())
                   : Vector3d(kBareEnd * links_[parent].length_m * incoming);
    }
    if (given && (given->direction || given->length_m)) {
      const Vector3d direction =
          given->direction
              ? *given->direction
              : (offset.isZero() ? Vector3d(Vector3d::UnitX()) : offset);
      const double length = given->length_m ? *given->length_m : offset.norm();
      const Vector3d told = length * direction.normalized();
      // A link that ends elsewhere than at the next joint does not share its
      // plane.
      if ((told - offset).norm() > kShortestLinkM) *next = -1;
      offset = told;
    }
    return offset;
  }

  // x along `direction`, y as little turned from the link before as can be.
  Eigen::Quaterniond LinkRotation(int joint, int parent,
                                  const Vector3d& direction) const {
    const SkinLinkOverride* given = override_of_[joint];
    const Eigen::Quaterniond joint_from_world =
        rest_[joint].rotation.conjugate();
    Eigen::Quaterniond rotation;
    if (parent >= 0) {
      const Eigen::Quaterniond joint_from_parent =
          joint_from_world * WorldFromLink(parent).rotation;
      rotation =
          ShortestRotation(joint_from_parent * Vector3d::UnitX(), direction) *
          joint_from_parent;
    } else {
      rotation = ShortestRotation(Vector3d::UnitX(), direction);
    }
    if (given && given->s_direction) {
      const Vector3d s = rotation.conjugate() * *given->s_direction;
      if (std::hypot(s.y(), s.z()) > kShortestLinkM * s.norm()) {
        rotation = rotation * Eigen::Quaterniond(Eigen::AngleAxisd(
                                  std::atan2(s.z(), s.y()), Vector3d::UnitX()));
      }
    }
    return rotation.normalized();
  }

  void AddLink(int joint) {
    const SkinLinkOverride* given = override_of_[joint];
    if (IsPassedOn(joint) || (given && given->omit)) return;
    SkinLink link;
    link.parent = ParentLink(joint);
    int next = -1;
    const Vector3d offset = EndOffset(
        joint, link.parent, IncomingDirection(joint, link.parent), &next);
    if (offset.norm() <= kShortestLinkM) return;
    link.id = skeleton_.joint(joint).id;
    link.joint = joint;
    link.length_m = offset.norm();
    link.joint_from_link.rotation =
        LinkRotation(joint, link.parent, offset.normalized());
    link.half_extents_m.setConstant(options_.slenderness * link.length_m);
    if (given && given->half_extents_m) {
      link.half_extents_m = *given->half_extents_m;
    }
    link.cap_reach_m.setConstant(link.half_extents_m.maxCoeff());
    link_of_[joint] = static_cast<int>(links_.size());
    links_.push_back(std::move(link));
    next_.push_back(next);
  }

  // The first link that hangs from each link and starts at its end.
  void Continue() {
    for (size_t i = 0; i < links_.size(); ++i) {
      const int parent = links_[i].parent;
      if (parent < 0 || next_[parent] < 0) continue;
      const RigidTransform& end = rest_[next_[parent]];
      const double gap =
          (rest_[links_[i].joint].translation - end.translation).norm();
      if (gap <= kShortestLinkM && links_[parent].continuation < 0) {
        links_[parent].continuation = static_cast<int>(i);
      }
    }
  }

  const Skeleton& skeleton_;
  const SkinLinkOptions& options_;
  Violations violations_;
  WorldTransforms rest_;
  std::vector<const SkinLinkOverride*> override_of_;  // of each joint
  std::vector<std::vector<int>> children_;            // of each joint
  std::vector<int> subtree_;                          // joints, itself included
  std::vector<int> link_of_;                          // of each joint, or -1
  std::vector<int> next_;  // the joint where each link ends, or -1
  std::vector<SkinLink> links_;
};

}  // namespace

absl::StatusOr<std::vector<SkinLink>> DeriveSkinLinks(
    const Skeleton& skeleton, const SkinLinkOptions& options) {
  return LinkDerivation(skeleton, options).Run();
}

Eigen::VectorXd RestPositionsOf(const Skeleton& skeleton,
                                const SkinLinkOptions& options) {
  return options.rest_positions.size() == 0 ? skeleton.rest_positions()
                                            : options.rest_positions;
}

}  // namespace gelenk
