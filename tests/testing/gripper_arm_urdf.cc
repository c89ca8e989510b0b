#include "tests/testing/gripper_arm_urdf.h"

namespace gelenk::testing {

std::string GripperArmUrdf() {
  return R"(<?xml version="1.0"?>
<robot name="gripper_arm">
  <link name="base"/>
  <link name="column">
    <inertial>
      <origin xyz="0 0 0.2" rpy="0 0 0"/>
      <mass value="8"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>
    </inertial>
  </link>
  <link name="carriage"/>
  <link name="upper_arm">
    <inertial><origin xyz="0.2 0 0"/><mass value="3"/></inertial>
  </link>
  <link name="wrist"/>
  <link name="forearm">
    <visual><geometry><cylinder radius="0.05" length="0.4"/></geometry></visual>
  </link>
  <link name="palm"/>
  <link name="tip_1"/>
  <link name="tip_2"/>
  <link name="tip_3"/>

  <joint name="yaw" type="continuous">
    <parent link="base"/>
    <child link="column"/>
    <origin xyz="0 0 0.1" rpy="0 0 0"/>
    <axis xyz="0 0 1"/>
    <limit effort="10" velocity="2"/>
  </joint>
  <!-- Before its parent joint. -->
  <joint name="elbow" type="revolute">
    <parent link="upper_arm"/>
    <child link="forearm"/>
    <origin xyz="0.4 0 0" rpy="0 0 -0.3"/>
    <axis xyz="0 1 0"/>
    <limit lower="0.1" upper="2.6" effort="10" velocity="3"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="column"/>
    <child link="carriage"/>
    <origin xyz="0.05 0 0.3" rpy="0.1 -0.2 0.3"/>
    <axis xyz="0 0 1"/>
    <limit lower="0" upper="0.5" effort="10" velocity="0.5"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <parent link="carriage"/>
    <child link="upper_arm"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1.5" upper="1.5" effort="10" velocity="3"/>
  </joint>
  <joint name="wrist" type="revolute">
    <parent link="forearm"/>
    <child link="palm"/>
    <origin xyz="0.35 0 0" rpy="1.2 0.4 -2"/>
    <axis xyz="0.6 0 -0.8"/>
    <limit lower="-2" upper="2" effort="10" velocity="5"/>
  </joint>
  <joint name="flange" type="fixed">
    <parent link="palm"/>
    <child link="wrist"/>
    <origin xyz="0 0.05 0" rpy="0 1.5707963267948966 0"/>
  </joint>
  <joint name="finger" type="prismatic">
    <parent link="wrist"/>
    <child link="tip_1"/>
    <origin xyz="0.1 0.02 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="0" upper="0.04" effort="1" velocity="0.1"/>
  </joint>
  <joint name="finger_right" type="prismatic">
    <parent link="wrist"/>
    <child link="tip_3"/>
    <origin xyz="0.1 0 0.02"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="0.1"/>
    <mimic joint="finger_left" multiplier="-0.5" offset="0.01"/>
  </joint>
  <joint name="finger_left" type="prismatic">
    <parent link="wrist"/>
    <child link="tip_2"/>
    <origin xyz="0.1 -0.02 0"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="0.1"/>
    <mimic joint="finger" multiplier="-1" offset="0.002"/>
  </joint>
</robot>
)";
}

}  // namespace gelenk::testing
