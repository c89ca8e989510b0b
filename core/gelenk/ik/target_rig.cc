#include "gelenk/ik/target_rig.h"

#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

// Of a free joint: x y z, then the quaternion.
constexpr int kNumbers = 7;
constexpr int kRotation = 3;

std::shared_ptr<const Skeleton> FreeJoints(int count) {
  SkeletonBounds bounds;
  bounds.max_joints = count + 1;
  SkeletonBuilder builder;
  builder.SetBounds(bounds);
  Joint root;
  root.id = "root";
  builder.AddJoint(root);
  for (int i = 0; i < count; ++i) {
    Joint joint;
    joint.id = absl::StrCat("goal", i);
    joint.parent_id = root.id;
    joint.type = JointType::kFree;
    builder.AddJoint(joint);
  }
  // Joints without limits under one root have no fault.
  return *builder.Build();
}

}  // namespace

TargetRig::TargetRig(int goal_count) : skeleton_(FreeJoints(goal_count)) {}

Eigen::VectorXd TargetRig::PositionsOf(absl::Span<const Goal> goals) const {
  Eigen::VectorXd positions = skeleton_->rest_positions();
  for (size_t i = 0; i < goals.size(); ++i) {
    Put(static_cast<int>(i), TargetOf(goals[i].kind), positions);
  }
  return positions;
}

bool TargetRig::Takes(const GoalTarget& target) {
  return std::holds_alternative<Eigen::Vector3d>(target) ||
         std::holds_alternative<Eigen::Quaterniond>(target) ||
         std::holds_alternative<RigidTransform>(target);
}

void TargetRig::Put(int goal_index, const GoalTarget& target,
                    VectorView positions) const {
  double* numbers = positions.data() + goal_index * kNumbers;
  if (const auto* point = std::get_if<Eigen::Vector3d>(&target)) {
    Eigen::Map<Eigen::Vector3d>{numbers} = *point;
  } else if (const auto* rotation = std::get_if<Eigen::Quaterniond>(&target)) {
    StoreXyzw(*rotation, numbers + kRotation);
  } else if (const auto* pose = std::get_if<RigidTransform>(&target)) {
    Eigen::Map<Eigen::Vector3d>{numbers} = pose->translation;
    StoreXyzw(pose->rotation, numbers + kRotation);
  }
}

void TargetRig::Aim(const ConstVectorView& positions,
                    IkProblem& problem) const {
  for (size_t i = 0; i < problem.goals().size(); ++i) {
    const double* numbers = positions.data() + i * kNumbers;
    const Eigen::Vector3d point(numbers[0], numbers[1], numbers[2]);
    const Eigen::Quaterniond rotation = QuaternionXyzw(numbers + kRotation);
    const int goal = static_cast<int>(i);
    const GoalKind& kind = problem.goals()[i].kind;
    if (Fits(kind, point)) {
      problem.SetTarget(goal, point);
    } else if (Fits(kind, rotation)) {
      problem.SetTarget(goal, rotation);
    } else if (const RigidTransform pose = {rotation, point};
               Fits(kind, pose)) {
      problem.SetTarget(goal, pose);
    }
  }
}

}  // namespace gelenk
