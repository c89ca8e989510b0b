#include "gelenk/kinematics/kinematic_tree.h"

#include <algorithm>
#include <cmath>

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using kernel::ForwardJoint;
using kernel::MotionType;

constexpr int kNumbersOfLine = 8;

kernel::ForwardFunction FunctionFor(InstructionSet level) {
#ifdef GELENK_X86_LEVELS
  if (level == InstructionSet::kAvx2) return kernel::avx2::RunForward;
  if (level == InstructionSet::kAvx512) return kernel::avx512::RunForward;
#endif
  return kernel::baseline::RunForward;
}

int PaddedToLine(int count) {
  return (count + kNumbersOfLine - 1) / kNumbersOfLine * kNumbersOfLine;
}

void StoreFrame(const RigidTransform& transform, double* numbers) {
  Eigen::Map<Eigen::Matrix4d> frame(numbers);
  frame.setIdentity();
  frame.topLeftCorner<3, 3>() = transform.rotation.toRotationMatrix();
  frame.topRightCorner<3, 1>() = transform.translation;
}

// 0, 1, 2 for +-X, +-Y, +-Z exactly, else -1.
int AlignedAxis(const Eigen::Vector3d& axis) {
  for (int k = 0; k < 3; ++k) {
    if (std::abs(axis[k]) == 1) return k;
  }
  return -1;
}

}  // namespace

class KinematicTreeBuilder {
 public:
  KinematicTreeBuilder(const Skeleton& skeleton, KinematicTree& tree)
      : skeleton_(skeleton), tree_(tree) {}

  void Build() {
    for (int i = 0; i < skeleton_.joint_count(); ++i) AddJoint(i);
    PlaceAxes();
    tree_.constants_.resize(PaddedToLine(static_cast<int>(constants_.size())) /
                            kNumbersOfLine);
    if (!constants_.empty()) {
      std::copy(constants_.begin(), constants_.end(),
                tree_.constants_[0].numbers);
    }
  }

 private:
  void AddJoint(int i) {
    const Joint& joint = skeleton_.joint(i);
    const int owner =
        skeleton_.span(i).mimicked < 0 ? i : skeleton_.span(i).mimicked;
    ForwardJoint out = {};
    out.parent = skeleton_.span(i).parent;
    out.constants = static_cast<int>(constants_.size());
    out.position = std::max(0, skeleton_.span(owner).position_offset);
    out.angle = -1;
    rest_ = joint.parent_from_joint.rotation.toRotationMatrix();
    const double multiplier = joint.mimic ? joint.mimic->multiplier : 1;
    const double offset = joint.mimic ? joint.mimic->offset : 0;
    AppendFrame(joint.parent_from_joint);
    switch (joint.type) {
      case JointType::kFixed:
        out.type = MotionType::kFixed;
        break;
      case JointType::kRevolute:
        AddRevolute(i, multiplier, offset, out);
        break;
      case JointType::kPrismatic:
        out.type = MotionType::kSlide;
        AppendColumn(rest_ * joint.axis);
        out.multiplier = multiplier;
        out.offset = offset;
        AddAxis(i, owner, 0, false, multiplier, joint.axis);
        break;
      case JointType::kSpherical:
        out.type = MotionType::kSpherical;
        AddBodyAxes(i, 0);
        break;
      case JointType::kPlanar:
        AddPlanar(i, out);
        break;
      case JointType::kFree:
        out.type = MotionType::kFree;
        for (int k = 0; k < 3; ++k) AddParentAxis(i, k, rest_.col(k));
        AddBodyAxes(i, 3);
        break;
    }
    tree_.joints_.push_back(out);
  }

  void AddRevolute(int i, double multiplier, double offset, ForwardJoint& out) {
    const Eigen::Vector3d& axis = skeleton_.joint(i).axis;
    const int owner =
        skeleton_.span(i).mimicked < 0 ? i : skeleton_.span(i).mimicked;
    const int aligned = AlignedAxis(axis);
    double sign = 1;
    if (aligned >= 0) {
      constexpr MotionType kTypes[] = {MotionType::kTurnX, MotionType::kTurnY,
                                       MotionType::kTurnZ};
      out.type = kTypes[aligned];
      sign = axis[aligned];
    } else {
      out.type = MotionType::kTurn;
      AppendTurn(out.constants, axis);
    }
    AddAngle(sign * multiplier, sign * offset, out);
    AddAxis(i, owner, 0, true, multiplier, axis);
  }

  void AddPlanar(int i, ForwardJoint& out) {
    const Joint& joint = skeleton_.joint(i);
    const Eigen::Matrix3d basis = PlanarBasis(joint.axis);
    out.type = MotionType::kPlanar;
    AppendTurn(out.constants, joint.axis);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d parent_axis = rest_ * basis.col(k);
      AppendColumn(parent_axis);
      AddParentAxis(i, k, parent_axis);
    }
    ForwardJoint angle = out;
    angle.position += 2;
    AddAngle(1, 0, angle);
    out.angle = angle.angle;
    AddAxis(i, i, 2, true, 1, joint.axis);
  }

  // Rotation by q about `axis` is a a^T + cos(q) (1 - a a^T) + sin(q) [a]x: the
  // rest's columns make way for the first term, the others follow.
  void AppendTurn(int rest, const Eigen::Vector3d& axis) {
    const Eigen::Matrix3d along = rest_ * axis * axis.transpose();
    for (int k = 0; k < 3; ++k) {
      for (int r = 0; r < 3; ++r) constants_[rest + 4 * k + r] = along(r, k);
    }
    for (int k = 0; k < 3; ++k) AppendColumn(rest_.col(k) - along.col(k));
    for (int k = 0; k < 3; ++k) {
      AppendColumn(rest_ * axis.cross(Eigen::Vector3d::Unit(k)));
    }
  }

  void AddAngle(double multiplier, double offset, ForwardJoint& out) {
    const int place = angle_count_ % kernel::kAngleBlock;
    if (place == 0) tree_.angles_.push_back({});
    tree_.angles_.back().multipliers[place] = multiplier;
    tree_.angles_.back().offsets[place] = offset;
    tree_.angles_.back().positions[place] = out.position;
    out.angle = angle_count_++;
  }

  // An axis that the joint's own motion leaves as it is: given in the joint's
  // frame.
  void AddAxis(int i, int owner, int k, bool rotation, double multiplier,
               const Eigen::Vector3d& joint_axis) {
    tree_.axes_.push_back(
        {i, skeleton_.span(owner).velocity_offset + k, rotation, multiplier});
    const int aligned = AlignedAxis(joint_axis);
    if (aligned >= 0 && joint_axis[aligned] > 0) {
      tree_.axis_places_.push_back(kernel::kFrameSize * i +
                                   kernel::kColumnSize * aligned);
    } else {
      AddFreeAxis(i, joint_axis);
    }
  }

  // Given in the parent's frame.
  void AddParentAxis(int i, int k, const Eigen::Vector3d& parent_axis) {
    tree_.axes_.push_back({i, skeleton_.span(i).velocity_offset + k, false, 1});
    AddFreeAxis(skeleton_.span(i).parent, parent_axis);
  }

  void AddBodyAxes(int i, int first) {
    for (int k = 0; k < 3; ++k) {
      AddAxis(i, i, first + k, true, 1, Eigen::Vector3d::Unit(k));
    }
  }

  void AddFreeAxis(int frame, const Eigen::Vector3d& direction) {
    tree_.axis_places_.push_back(-1 -
                                 static_cast<int>(tree_.free_axes_.size()));
    tree_.free_axes_.push_back(
        {{direction.x(), direction.y(), direction.z(), 0}, frame});
  }

  // Free axes are stored behind the frames.
  void PlaceAxes() {
    const int frames = kernel::kFrameSize * skeleton_.joint_count();
    for (int& place : tree_.axis_places_) {
      if (place < 0) place = frames + kernel::kColumnSize * (-1 - place);
    }
  }

  void AppendFrame(const RigidTransform& transform) {
    constants_.resize(constants_.size() + kernel::kFrameSize);
    StoreFrame(transform,
               constants_.data() + constants_.size() - kernel::kFrameSize);
  }

  void AppendColumn(const Eigen::Vector3d& v) {
    constants_.insert(constants_.end(), {v.x(), v.y(), v.z(), 0});
  }

  const Skeleton& skeleton_;
  KinematicTree& tree_;
  std::vector<double> constants_;
  int angle_count_ = 0;
  Eigen::Matrix3d rest_;  // of the joint that is being added
};

KinematicTree::KinematicTree(const Skeleton& skeleton, InstructionSet level)
    : evaluate_(FunctionFor(level)) {
  KinematicTreeBuilder(skeleton, *this).Build();
}

void KinematicTree::Evaluate(const ConstVectorView& positions,
                             const RigidTransform& world_from_skeleton,
                             KinematicFrames& frames) const {
  const int frame_numbers = kernel::kFrameSize * joint_count();
  const int axis_numbers =
      PaddedToLine(kernel::kColumnSize * static_cast<int>(free_axes_.size()));
  const int angle_numbers =
      kernel::kAngleBlock * static_cast<int>(angles_.size());
  const int lines =
      (frame_numbers + axis_numbers + 2 * angle_numbers) / kNumbersOfLine;
  if (static_cast<int>(frames.memory_.size()) < lines) {
    frames.memory_.resize(lines);
  }
  kernel::ForwardWorkspace work;
  work.frames = frames.memory_[0].numbers;
  work.axes = work.frames + frame_numbers;
  work.sines = work.axes + axis_numbers;
  work.cosines = work.sines + angle_numbers;
  KinematicFrames::CacheLine base[2];
  StoreFrame(world_from_skeleton, base[0].numbers);
  const kernel::ForwardLayout layout = {joints_.data(),
                                        angles_.data(),
                                        free_axes_.data(),
                                        constants_[0].numbers,
                                        joint_count(),
                                        static_cast<int>(angles_.size()),
                                        static_cast<int>(free_axes_.size())};
  evaluate_(layout, positions.data(), base[0].numbers, work);
}

}  // namespace gelenk
