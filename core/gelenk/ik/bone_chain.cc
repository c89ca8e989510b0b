#include "gelenk/ik/bone_chain.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using kernel::Node;
using kernel::NodeType;

constexpr double kTurn = 2 * std::numbers::pi;
// Axes that meet or are parallel or perpendicular but for rounding.
constexpr double kExact = 1e-9;

Matrix3d RotationOf(const Node& node) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
      node.parent_from_rest_rotation);
}

Vector3d VectorOf(const kernel::Vector3& v) { return {v[0], v[1], v[2]}; }

Matrix3d AboutZ(double sine, double cosine) {
  Matrix3d m;
  m << cosine, -sine, 0, sine, cosine, 0, 0, 0, 1;
  return m;
}

// A turn of the frame before by angle q, then to the next frame.
Matrix3d AboutZ(double angle) {
  return AboutZ(std::sin(angle), std::cos(angle));
}

// `angle` moved by whole turns into [lower, upper], at least a turn wide.
double IntoRange(double angle, double lower, double upper) {
  if (angle > upper) angle -= kTurn * std::ceil((angle - upper) / kTurn);
  if (angle < lower) angle += kTurn * std::ceil((lower - angle) / kTurn);
  return angle;
}

// `angle` moved by whole turns to within half a turn of `reference`.
double NearTo(double reference, double angle) {
  return reference + std::remainder(angle - reference, kTurn);
}

absl::Status NoPivot(const Skeleton& skeleton, int joint,
                     absl::string_view why) {
  return absl::InvalidArgumentError(
      absl::StrCat("joint \"", skeleton.joint(joint).id, "\": ", why));
}

}  // namespace

class BoneChainBuilder {
 public:
  BoneChainBuilder(const Skeleton& skeleton, const kernel::TreeLayout& tree,
                   absl::Span<const int> joints_of_nodes)
      : skeleton_(skeleton), tree_(tree), joints_of_nodes_(joints_of_nodes) {}

  absl::StatusOr<BoneChain> Build() {
    if (absl::Status status = CheckTask(); !status.ok()) return status;
    for (int n = 0; n < tree_.node_count; ++n) {
      if (absl::Status status = CheckNode(n); !status.ok()) return status;
    }
    chain_.is_planar_ = AxesAreParallel();
    chain_.skeleton_origin_ =
        VectorOf(tree_.nodes[0].parent_from_rest_translation);
    chain_.skeleton_normal_ = RotationOf(tree_.nodes[0]).col(2);
    for (int n = 0; n < tree_.node_count;) {
      if (absl::Status status = AddBone(n); !status.ok()) return status;
    }
    FindReach();
    chain_.bones_.shrink_to_fit();
    chain_.lengths_.shrink_to_fit();
    return std::move(chain_);
  }

 private:
  absl::Status CheckTask() const {
    const bool one_position = tree_.task_count == 1 &&
                              tree_.tasks[0].row_begin == 0 &&
                              tree_.tasks[0].row_end == 3;
    if (!one_position) {
      return absl::InvalidArgumentError("want one position goal");
    }
    if (tree_.node_count == 0) {
      return absl::InvalidArgumentError("nothing moves the end effector");
    }
    return absl::OkStatus();
  }

  absl::Status CheckNode(int n) const {
    const Node& node = tree_.nodes[n];
    const int joint = joints_of_nodes_[n];
    if (node.type != NodeType::kRevolute && node.type != NodeType::kSpherical) {
      return NoPivot(skeleton_, joint, "want a revolute or spherical one");
    }
    if (node.mimics) return NoPivot(skeleton_, joint, "mimics another");
    bool limited = false;
    if (node.type == NodeType::kRevolute) {
      limited =
          tree_.upper[node.axis] - tree_.lower[node.axis] < kTurn - kExact;
    } else if (node.limits_rotation) {
      const kernel::RotationLimit& limit = tree_.rotation_limits[n];
      limited = limit.swing_cone < std::numbers::pi ||
                std::isfinite(limit.twist_lower) ||
                std::isfinite(limit.twist_upper);
    }
    if (limited) return NoPivot(skeleton_, joint, "has limits");
    return absl::OkStatus();
  }

  bool AxesAreParallel() const {
    for (int n = 0; n < tree_.node_count; ++n) {
      if (tree_.nodes[n].type != NodeType::kRevolute) return false;
      if (n > 0 &&
          RotationOf(tree_.nodes[n]).col(2).head<2>().norm() > kExact) {
        return false;
      }
    }
    return true;
  }

  // The pivot that starts at node `n`, which moves on to the next one's.
  absl::Status AddBone(int& n) {
    BoneChain::Bone bone = {};
    int joint_count = 1;
    if (tree_.nodes[n].type == NodeType::kSpherical) {
      bone.type = BoneChain::PivotType::kSpherical;
    } else if (chain_.is_planar_) {
      bone.type = BoneChain::PivotType::kHinge;
    } else {
      if (absl::Status status = CheckGimbal(n); !status.ok()) return status;
      bone.type = BoneChain::PivotType::kGimbal;
      joint_count = 3;
    }
    for (int k = 0; k < joint_count; ++k) {
      const Node& node = tree_.nodes[n + k];
      bone.rests[k] = RotationOf(node);
      bone.positions[k] = node.position;
      bone.lower[k] = tree_.lower[node.axis];
      bone.upper[k] = tree_.upper[node.axis];
    }
    if (joint_count == 3) {
      // See TurnGimbal.
      bone.lock_angle = std::atan2(bone.rests[1](2, 1), bone.rests[1](2, 0)) -
                        std::atan2(bone.rests[2](1, 2), bone.rests[2](0, 2));
    }
    n += joint_count;
    AddVector(n, bone);
    chain_.bones_.push_back(bone);
    return absl::OkStatus();
  }

  absl::Status CheckGimbal(int n) const {
    bool fits = n + 2 < tree_.node_count;
    for (int k = n + 1; fits && k <= n + 2; ++k) {
      const Node& node = tree_.nodes[k];
      fits = node.type == NodeType::kRevolute &&
             VectorOf(node.parent_from_rest_translation).norm() < kExact &&
             std::abs(RotationOf(node)(2, 2)) < kExact;
    }
    if (fits) return absl::OkStatus();
    return NoPivot(skeleton_, joints_of_nodes_[n],
                   "want its axis parallel to all others, or three axes that "
                   "meet, each perpendicular to the next");
  }

  // From this pivot to that of node `next`, or to the tip.
  void AddVector(int next, BoneChain::Bone& bone) {
    Vector3d vector =
        next < tree_.node_count
            ? VectorOf(tree_.nodes[next].parent_from_rest_translation)
            : VectorOf(tree_.tasks[0].node_from_effector_translation);
    if (bone.type == BoneChain::PivotType::kHinge) {
      // Axes may point either way.
      if (next > 1 && bone.rests[0](2, 2) < 0) side_ = -side_;
      chain_.height_m_ += side_ * vector.z();
      vector.z() = 0;
    }
    const double length = vector.norm();
    bone.direction = length > 0 ? Vector3d(vector / length) : vector;
    chain_.lengths_.push_back(length);
  }

  void FindReach() {
    const std::vector<double>& lengths = chain_.lengths_;
    const double longest = *std::max_element(lengths.begin(), lengths.end());
    const double sum = std::accumulate(lengths.begin(), lengths.end(), 0.0);
    chain_.folded_reach_m_ = 2 * longest - sum;
    chain_.longest_reach_m_ = sum;
  }

  const Skeleton& skeleton_;
  const kernel::TreeLayout& tree_;
  const absl::Span<const int> joints_of_nodes_;
  BoneChain chain_;
  double side_ = 1;  // of the plane to which the last hinge's axis points
};

absl::StatusOr<BoneChain> BoneChain::Of(const Skeleton& skeleton,
                                        const kernel::TreeLayout& tree,
                                        absl::Span<const int> joints_of_nodes) {
  return BoneChainBuilder(skeleton, tree, joints_of_nodes).Build();
}

Matrix3d BoneChain::TurnOf(const Bone& bone, const ConstVectorView& positions) {
  const double* q = positions.data();
  switch (bone.type) {
    case PivotType::kSpherical:
      return bone.rests[0] *
             QuaternionXyzw(q + bone.positions[0]).toRotationMatrix();
    case PivotType::kHinge:
      return bone.rests[0] * AboutZ(q[bone.positions[0]]);
    case PivotType::kGimbal:
      break;
  }
  return bone.rests[0] * AboutZ(q[bone.positions[0]]) *
         (bone.rests[1] * AboutZ(q[bone.positions[1]])) *
         (bone.rests[2] * AboutZ(q[bone.positions[2]]));
}

void BoneChain::ComputePose(const ConstVectorView& positions,
                            const RigidTransform& world_from_skeleton,
                            BonePose& pose) const {
  pose.points.resize(bones_.size() + 1);
  pose.turns.resize(bones_.size());
  Matrix3d rotation = world_from_skeleton.rotation.toRotationMatrix();
  pose.points[0] = world_from_skeleton * skeleton_origin_;
  for (size_t k = 0; k < bones_.size(); ++k) {
    pose.turns[k] = TurnOf(bones_[k], positions);
    rotation = (rotation * pose.turns[k]).eval();
    pose.points[k + 1] =
        pose.points[k] + rotation * (lengths_[k] * bones_[k].direction);
  }
}

Vector3d BoneChain::LastPointFor(const RigidTransform& world_from_skeleton,
                                 const Vector3d& world_target) const {
  if (!is_planar_) return world_target;
  const Vector3d normal = world_from_skeleton.rotation * skeleton_normal_;
  const Vector3d way = world_target - world_from_skeleton * skeleton_origin_;
  return world_target - way.dot(normal) * normal;
}

Vector3d BoneChain::AnyAcross(const RigidTransform& world_from_skeleton,
                              const Vector3d& way) const {
  if (!is_planar_) {
    return way.isZero(0) ? Vector3d::UnitX() : way.unitOrthogonal();
  }
  const Vector3d normal = world_from_skeleton.rotation * skeleton_normal_;
  const Vector3d across = normal.cross(way);
  return across.isZero(0) ? normal.unitOrthogonal() : across.normalized();
}

bool BoneChain::Reaches(const RigidTransform& world_from_skeleton,
                        const Vector3d& last) const {
  const double distance =
      (last - world_from_skeleton * skeleton_origin_).norm();
  const bool folds_up = folded_reach_m_ >= 0 && distance <= folded_reach_m_;
  return distance < longest_reach_m_ && !folds_up;
}

void BoneChain::ReachOut(const Vector3d& last, BonePose& pose) const {
  std::vector<Vector3d>& points = pose.points;
  const Vector3d way = last - points[0];
  const double distance = way.norm();
  // Right on the first pivot any direction does; in a plane one of its own.
  const Vector3d direction = distance > 0
                                 ? Vector3d(way / distance)
                                 : (points[1] - points[0]).normalized();
  const bool too_far = distance >= longest_reach_m_;
  const auto longest = std::max_element(lengths_.begin(), lengths_.end());
  for (size_t k = 0; k < lengths_.size(); ++k) {
    // Too near: the longest bone goes beyond, the others all come back.
    const bool onwards = too_far || &*longest == &lengths_[k];
    points[k + 1] = points[k] + (onwards ? 1 : -1) * lengths_[k] * direction;
  }
}

void BoneChain::TurnHinge(const Bone& bone, double angle,
                          VectorView positions) {
  double& q = positions[bone.positions[0]];
  q = IntoRange(q + angle, bone.lower[0], bone.upper[0]);
}

// With joint angles a, b, c, rests A, B of the second and third joint:
//   turn = Rz(a) A Rz(b) B Rz(c).
// What turn makes of z, the third axis, has nothing of c; its height along the
// first axis nothing of a: it is cos(b - lock angle). The two angles b with
// that cosine are the two ways to point; the present one's is kept.
void BoneChain::TurnGimbal(const Bone& bone, const Matrix3d& turn,
                           VectorView positions) {
  double* q[3];
  for (int k = 0; k < 3; ++k) q[k] = &positions[bone.positions[k]];
  const Vector3d third = turn.col(2);
  const double sine = third.head<2>().norm();
  const double side = std::sin(*q[1] - bone.lock_angle) < 0 ? -1 : 1;
  const double b = bone.lock_angle + std::atan2(side * sine, third.z());
  const Matrix3d second = bone.rests[1] * AboutZ(b) * bone.rests[2];
  double a = *q[0];
  if (sine > kExact) {
    // In the lock the first and third joint do the same; the first stays.
    a = std::atan2(second(0, 2) * third.y() - second(1, 2) * third.x(),
                   second(0, 2) * third.x() + second(1, 2) * third.y());
  }
  const Matrix3d rest = (AboutZ(a) * second).transpose() * turn;
  const double c = std::atan2(rest(1, 0) - rest(0, 1), rest(0, 0) + rest(1, 1));
  const double angles[3] = {a, b, c};
  for (int k = 0; k < 3; ++k) {
    *q[k] = IntoRange(NearTo(*q[k], angles[k]), bone.lower[k], bone.upper[k]);
  }
}

Vector3d BoneChain::Follow(const BonePose& pose,
                           const RigidTransform& world_from_skeleton,
                           VectorView positions) const {
  const std::vector<Vector3d>& points = pose.points;
  Matrix3d rotation = world_from_skeleton.rotation.toRotationMatrix();
  Vector3d tip = points[0];
  for (size_t k = 0; k < bones_.size(); ++k) {
    const Bone& bone = bones_[k];
    const Matrix3d unturned = rotation * pose.turns[k];
    rotation = unturned;
    const double length = lengths_[k];
    if (length > 0) {
      // Where it is to point, in its own frame.
      const Vector3d to =
          unturned.transpose() * (points[k + 1] - points[k]) / length;
      const Vector3d& from = bone.direction;
      if (bone.type == PivotType::kHinge) {
        const double sine = from.x() * to.y() - from.y() * to.x();
        const double cosine = from.x() * to.x() + from.y() * to.y();
        const double norm = std::hypot(sine, cosine);
        rotation = unturned * AboutZ(sine / norm, cosine / norm);
        TurnHinge(bone, std::atan2(sine, cosine), positions);
      } else {
        const Eigen::Quaterniond turn = ShortestRotation(from, to.normalized());
        const Matrix3d matrix = turn.toRotationMatrix();
        rotation = unturned * matrix;
        if (bone.type == PivotType::kSpherical) {
          double* q = positions.data() + bone.positions[0];
          StoreXyzw((QuaternionXyzw(q) * turn).normalized(), q);
        } else {
          TurnGimbal(bone, bone.rests[0].transpose() * pose.turns[k] * matrix,
                     positions);
        }
      }
    }
    tip += rotation * (length * bone.direction);
  }
  if (is_planar_) {
    tip += height_m_ * (world_from_skeleton.rotation * skeleton_normal_);
  }
  return tip;
}

}  // namespace gelenk
