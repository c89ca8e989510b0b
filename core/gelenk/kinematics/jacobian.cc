#include "gelenk/kinematics/jacobian.h"

#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Adds the columns of one joint.
class ColumnWriter {
 public:
  ColumnWriter(const Eigen::Vector3d& world_tip, Jacobian& jacobian)
      : world_tip_(world_tip), jacobian_(jacobian) {}

  void AddTranslation(int column, const Eigen::Vector3d& world_axis,
                      double scale = 1) {
    jacobian_.col(column).head<3>() += scale * world_axis;
  }

  void AddRotation(int column, const Eigen::Vector3d& world_axis,
                   const Eigen::Vector3d& world_origin, double scale = 1) {
    jacobian_.col(column).head<3>() +=
        scale * world_axis.cross(world_tip_ - world_origin);
    jacobian_.col(column).tail<3>() += scale * world_axis;
  }

 private:
  const Eigen::Vector3d world_tip_;
  Jacobian& jacobian_;
};

void AddJoint(const Skeleton& skeleton, int index,
              const RigidTransform& world_from_rest,
              const RigidTransform& world_from_joint, ColumnWriter& writer) {
  const Joint& joint = skeleton.joint(index);
  const JointSpan& span = skeleton.span(index);
  const int owner = span.mimicked < 0 ? index : span.mimicked;
  const int v = skeleton.span(owner).velocity_offset;
  const double scale = joint.mimic ? joint.mimic->multiplier : 1;
  const Eigen::Vector3d origin = world_from_joint.translation;
  const auto add_rotations = [&](int first) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d axis =
          world_from_joint.rotation * Eigen::Vector3d::Unit(k);
      writer.AddRotation(first + k, axis, origin);
    }
  };
  switch (joint.type) {
    case JointType::kFixed:
      return;
    case JointType::kRevolute:
      return writer.AddRotation(v, world_from_rest.rotation * joint.axis,
                                origin, scale);
    case JointType::kPrismatic:
      return writer.AddTranslation(v, world_from_rest.rotation * joint.axis,
                                   scale);
    case JointType::kSpherical:
      return add_rotations(v);
    case JointType::kPlanar: {
      const Eigen::Matrix3d basis = PlanarBasis(joint.axis);
      for (int k = 0; k < 2; ++k) {
        const Eigen::Vector3d axis = basis.col(k);
        writer.AddTranslation(v + k, world_from_rest.rotation * axis);
      }
      return writer.AddRotation(v + 2, world_from_rest.rotation * joint.axis,
                                origin);
    }
    case JointType::kFree:
      for (int k = 0; k < 3; ++k) {
        writer.AddTranslation(
            v + k, world_from_rest.rotation * Eigen::Vector3d::Unit(k));
      }
      return add_rotations(v + 3);
  }
}

}  // namespace

void ComputeJacobian(const Skeleton& skeleton, const ConstVectorView& positions,
                     const WorldTransforms& world_from_joints,
                     const EffectorFrame& effector, Jacobian& jacobian) {
  jacobian.setZero(6, skeleton.velocity_count());
  const Eigen::Vector3d world_tip = world_from_joints[effector.joint] *
                                    effector.joint_from_effector.translation;
  ColumnWriter writer(world_tip, jacobian);
  for (int i = effector.joint; i >= 0; i = skeleton.span(i).parent) {
    // The rest frame follows from the joint's frame and its motion.
    const RigidTransform world_from_rest =
        world_from_joints[i] * JointMotion(skeleton, i, positions).Inverse();
    AddJoint(skeleton, i, world_from_rest, world_from_joints[i], writer);
  }
}

}  // namespace gelenk
