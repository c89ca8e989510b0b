#include "tests/testing/example_bodies.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::testing {
namespace {

Joint Ball(const std::string& id, const std::string& parent_id,
           const Eigen::Vector3d& offset_m) {
  Joint joint;
  joint.id = id;
  joint.parent_id = parent_id;
  joint.type = JointType::kSpherical;
  joint.parent_from_joint.translation = offset_m;
  joint.limits.swing_cone_rad = 1.6;
  joint.limits.twist_lower_rad = -1.2;
  joint.limits.twist_upper_rad = 1.2;
  return joint;
}

EndEffector Tip(const std::string& id, const std::string& joint_id,
                const Eigen::Vector3d& offset_m) {
  return {id, joint_id, {Eigen::Quaterniond::Identity(), offset_m}};
}

// Adds a chain of joints below `parent_id`, `step_m` apart.
std::string AddChain(SkeletonBuilder& builder, std::string parent_id,
                     const std::vector<std::string>& ids,
                     const Eigen::Vector3d& step_m) {
  for (const std::string& id : ids) {
    builder.AddJoint(Ball(id, parent_id, step_m));
    parent_id = id;
  }
  return parent_id;
}

void AddArm(SkeletonBuilder& builder, const std::string& side, double sign) {
  const Eigen::Vector3d out(sign, 0, 0);
  const std::string hand =
      AddChain(builder, "spine4",
               {side + "_clavicle", side + "_upper_arm", side + "_arm_twist",
                side + "_forearm", side + "_forearm_twist", side + "_hand"},
               0.12 * out);
  for (int finger = 0; finger < 5; ++finger) {
    const std::string name = absl::StrCat(side, "_finger", finger);
    AddChain(builder, hand, {name + "a", name + "b", name + "c"},
             {sign * 0.03, 0, 0.02 * (finger - 2)});
  }
  builder.AddEndEffector(Tip(side + "_palm", hand, 0.08 * out));
}

void AddLeg(SkeletonBuilder& builder, const std::string& side, double sign) {
  builder.AddJoint(Ball(side + "_thigh", "hips", {sign * 0.1, -0.05, 0}));
  const std::string foot =
      AddChain(builder, side + "_thigh", {side + "_shin", side + "_foot"},
               {0, -0.42, 0});
  builder.AddJoint(Ball(side + "_toe", foot, {0, -0.06, 0.15}));
  builder.AddEndEffector(Tip(side + "_sole", foot, {0, -0.08, 0.05}));
}

}  // namespace

std::shared_ptr<const Skeleton> PersonWithFingers() {
  SkeletonBuilder builder;
  Joint hips = Ball("hips", "", {0, 0.95, 0});
  hips.type = JointType::kFree;
  hips.limits = {};
  builder.AddJoint(hips);
  const std::string chest = AddChain(
      builder, "hips", {"spine1", "spine2", "spine3", "spine4"}, {0, 0.12, 0});
  builder.AddEndEffector(Tip("chest", chest, {0, 0.05, 0.1}));
  const std::string head =
      AddChain(builder, chest, {"neck1", "neck2", "head"}, {0, 0.06, 0});
  AddChain(builder, head, {"jaw1", "jaw2"}, {0, 0, 0.05});
  for (const char* eye : {"left_eye", "right_eye"}) {
    builder.AddJoint(Ball(eye, head, {0, 0.08, 0.09}));
  }
  builder.AddEndEffector(Tip("crown", head, {0, 0.2, 0}));
  AddArm(builder, "left", 1);
  AddArm(builder, "right", -1);
  AddLeg(builder, "left", 1);
  AddLeg(builder, "right", -1);
  AddChain(builder, "hips", {"tail1", "tail2"}, {0, 0, -0.05});
  return builder.Build().value();
}

std::shared_ptr<const Skeleton> SixTentacles() {
  constexpr int kChains = 6;
  constexpr int kJoints = 64;
  SkeletonBuilder builder;
  builder.AddJoint(Ball("root", "", {0, 0, 0}));
  std::string ends[kChains] = {"root", "root", "root", "root", "root", "root"};
  for (int i = 1; i < kJoints; ++i) {
    std::string& end = ends[i % kChains];
    builder.AddJoint(Ball(absl::StrCat("j", i), end, {0.1, 0.02, 0}));
    end = absl::StrCat("j", i);
  }
  for (int i = 0; i < kChains; ++i) {
    builder.AddEndEffector(Tip(absl::StrCat("tip", i), ends[i], {0.1, 0, 0}));
  }
  return builder.Build().value();
}

}  // namespace gelenk::testing
