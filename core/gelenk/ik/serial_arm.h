// The chain of joints that carries the one effector of a problem, where that is
// an arm: a few revolute and prismatic joints in a row (fixed ones in between
// are fine), none of which is mimicked or mimics.
//
// Immutable, safe to read from any thread. Depends on the skeleton and on the
// effector, like the SparseTree that it is made from.
#ifndef GELENK_IK_SERIAL_ARM_H_
#define GELENK_IK_SERIAL_ARM_H_

#include <Eigen/Geometry>
#include <array>
#include <memory>

#include "gelenk/ik/goal.h"
#include "gelenk/ik/kernel/arm_layout.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

class SerialArm {
 public:
  // Null where `tree` is no arm. Keeps no reference to it.
  static std::unique_ptr<const SerialArm> Create(
      const kernel::TreeLayout& tree);

  const kernel::ArmLayout& layout() const { return layout_; }
  int joint_count() const { return layout_.joint_count; }
  bool turns(int joint) const { return layout_.turn[joint] != 0; }

  // The numbers of its joints out of a skeleton's, and back.
  void Gather(const ConstVectorView& positions, kernel::ArmRow& q) const;
  void Scatter(const kernel::ArmRow& q, VectorView positions) const;

  // False where an angle is beyond what the kernels take.
  bool Takes(const kernel::ArmRow& q) const;

  // What the kernels need of a tree's settings and of its one target, which is
  // active.
  void Prepare(const kernel::Settings& settings,
               const kernel::TaskTarget& target,
               kernel::ArmSettings& arm_settings) const;
  void Prepare(const kernel::TaskTarget& target,
               kernel::ArmTarget& arm_target) const;
  // The same from the target of the goal itself: a point, an orientation or a
  // pose.
  void Prepare(const GoalTarget& target, kernel::ArmTarget& arm_target) const;

  // Moves `q` inside the bounds.
  void Clamp(const kernel::ArmSettings& settings, kernel::ArmRow& q) const;

  // True where a joint that slides has no bound on some side.
  bool HasFreeSlide(const kernel::ArmSettings& settings) const;

  // True where the tip surely cannot get to the target, however the joints are.
  bool IsOutOfReach(const kernel::ArmSettings& settings,
                    const kernel::ArmTarget& target) const;

 private:
  SerialArm() = default;

  kernel::ArmLayout layout_ = {};
  std::array<int, kernel::kMaxArmJoints> positions_ = {};  // in q, per joint
  Eigen::Quaterniond tip_from_last_ = Eigen::Quaterniond::Identity();
  // From the first joint's origin to the tip with all links in a row, m.
  double length_ = 0;
  // Which rows the task has.
  bool has_translation_ = false;
  bool has_rotation_ = false;
};

}  // namespace gelenk

#endif  // GELENK_IK_SERIAL_ARM_H_
