// A robot arm with a gripper as URDF, for everything that takes such files.
#ifndef GELENK_TESTS_TESTING_GRIPPER_ARM_URDF_H_
#define GELENK_TESTS_TESTING_GRIPPER_ARM_URDF_H_

#include <string>

namespace gelenk::testing {

// Joints: "yaw" (continuous), "lift" (prismatic), "shoulder", "elbow" and
// "wrist" (revolute, the wrist about a skew axis), "flange" (fixed), "finger"
// (prismatic) and "finger_right", which mimics "finger_left", which mimics
// "finger" in turn. The elbow cannot be straight. Links: "base", "palm", ...;
// the joint "wrist" does not move the link of that name.
std::string GripperArmUrdf();

inline constexpr int kGripperArmJointCount = 10;  // With the root's.
inline constexpr int kGripperArmPositionCount = 6;

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_GRIPPER_ARM_URDF_H_
