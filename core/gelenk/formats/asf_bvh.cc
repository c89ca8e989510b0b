#include "gelenk/formats/asf_bvh.h"

#include <Eigen/Geometry>
#include <numbers>

#include "absl/strings/str_cat.h"
#include "gelenk/math/euler.h"

namespace gelenk {
namespace {

constexpr double kDegreePerRad = 180 / std::numbers::pi;
constexpr EulerAxes kAxes = {2, 0, 1};
constexpr BvhChannel kRotations[] = {
    BvhChannel::kZrotation, BvhChannel::kXrotation, BvhChannel::kYrotation};
constexpr BvhChannel kPositions[] = {
    BvhChannel::kXposition, BvhChannel::kYposition, BvhChannel::kZposition};

// Turns about fixed axes, one after the other.
Eigen::Quaterniond FixedTurns(const EulerAxes& order,
                              const Eigen::Vector3d& angles_rad) {
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (int axis : order) {
    turn =
        Eigen::AngleAxisd(angles_rad[axis], Eigen::Vector3d::Unit(axis)) * turn;
  }
  return turn;
}

bool Turns(const AsfBone& bone) {
  for (BvhChannel dof : bone.dofs) {
    if (!IsPosition(dof)) return true;
  }
  return false;
}

int RotationCount(const AsfBone& bone) {
  int count = 0;
  for (BvhChannel dof : bone.dofs) count += IsPosition(dof) ? 0 : 1;
  return count;
}

// What a bone does in a frame, in the world's axes at rest.
struct BoneMotion {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

BoneMotion MotionOf(const AsfBone& bone, const double* numbers) {
  BoneMotion motion;
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();
  for (BvhChannel dof : bone.dofs) {
    (IsPosition(dof) ? motion.translation : angles)[AxisOf(dof)] = *numbers++;
  }
  const Eigen::Quaterniond axis = FixedTurns(bone.axis_order, bone.axis_rad);
  motion.rotation =
      axis * FixedTurns(bone.axis_order, angles) * axis.conjugate();
  return motion;
}

void AddJoints(const AsfDocument& skeleton, BvhDocument& document) {
  std::vector<bool> has_child(skeleton.bones.size(), false);
  int stiff = 0;
  for (const AsfBone& bone : skeleton.bones) {
    BvhJoint joint;
    joint.name = bone.name;
    joint.parent = bone.parent;
    if (bone.parent < 0) {
      joint.offset = skeleton.root_position;
      joint.channels.assign(std::begin(kPositions), std::end(kPositions));
    } else {
      const AsfBone& parent = skeleton.bones[bone.parent];
      joint.offset = parent.length * parent.direction;
      has_child[bone.parent] = true;
    }
    if (bone.parent < 0 || Turns(bone)) {
      joint.channels.insert(joint.channels.end(), std::begin(kRotations),
                            std::end(kRotations));
    }
    if (bone.parent >= 0 && Turns(bone) && RotationCount(bone) < 3) ++stiff;
    document.joints.push_back(std::move(joint));
  }
  for (size_t i = 0; i < skeleton.bones.size(); ++i) {
    const AsfBone& bone = skeleton.bones[i];
    if (has_child[i] || bone.length == 0) continue;
    document.joints[i].end_sites.push_back({"", bone.length * bone.direction});
  }
  if (stiff > 0) {
    document.warnings.push_back(absl::StrCat(
        stiff, " bones of one or two angles are joints that turn all ways"));
  }
}

}  // namespace

BvhDocument BvhFromAsf(const AsfDocument& skeleton, const AmcMotion& motion,
                       double frame_time_s) {
  BvhDocument document;
  document.frame_time_s = frame_time_s;
  document.warnings = skeleton.warnings;
  AddJoints(skeleton, document);
  document.motion.resize(document.channel_count(), motion.numbers.cols());
  for (Eigen::Index f = 0; f < motion.numbers.cols(); ++f) {
    const double* numbers = motion.numbers.col(f).data();
    int row = 0;
    for (size_t i = 0; i < skeleton.bones.size(); ++i) {
      const AsfBone& bone = skeleton.bones[i];
      const BoneMotion moved = MotionOf(bone, numbers);
      numbers += bone.dofs.size();
      if (bone.parent < 0) {
        document.motion.block<3, 1>(row, f) =
            skeleton.root_position + moved.translation;
        row += 3;
      }
      if (document.joints[i].channels.empty()) continue;
      Eigen::Vector3d near_rad = Eigen::Vector3d::Zero();
      if (f > 0) {
        near_rad = document.motion.block<3, 1>(row, f - 1) / kDegreePerRad;
      }
      document.motion.block<3, 1>(row, f) =
          kDegreePerRad * EulerFromRotation(kAxes, moved.rotation, near_rad);
      row += 3;
    }
  }
  return document;
}

}  // namespace gelenk
