#include "gelenk/ik/serial_arm.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "gelenk/math/rigid_transform.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using kernel::kMaxArmJoints;
using ConstMatrix3 =
    Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;
using RowMajor3 = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>;

// The kernels' sines are good up to 1e5 rad; a solve may turn a joint by some.
constexpr double kLargestAngle = 9e4;
// Sines and cosines of twists this near to 0 or 1, and lengths this near to 0
// as a part of the arm's, are so but for rounding.
constexpr double kRounding = 1e-13;
// Axes whose cross product is shorter are parallel: rounding alone turns the
// common perpendicular.
constexpr double kParallel = 1e-12;

// The neutral pose of one joint, in the frame of the base.
struct Link {
  Vector3d axis;
  Vector3d origin;
};

double Snapped(double value, double rounding) {
  const double whole = std::round(value);
  return std::abs(value - whole) < rounding && std::abs(whole) <= 1 ? whole
                                                                    : value;
}

double SnappedToZero(double value, double rounding) {
  return std::abs(value) < rounding ? 0 : value;
}

bool IsScalar(const kernel::Node& node) {
  return !node.mimics && (node.type == kernel::NodeType::kRevolute ||
                          node.type == kernel::NodeType::kPrismatic);
}

bool IsArm(const kernel::TreeLayout& tree) {
  if (tree.task_count != 1 || tree.node_count < 1 ||
      tree.node_count > kMaxArmJoints || tree.column_count != tree.node_count ||
      tree.tasks[0].shape != kernel::GoalShape::kPose ||
      tree.tasks[0].node != tree.node_count - 1) {
    return false;
  }
  for (int i = 0; i < tree.node_count; ++i) {
    const kernel::Node& node = tree.nodes[i];
    // Parents first, and all of them ancestors of the effector: in a row.
    if (!IsScalar(node) || tree.columns[i].node != i) return false;
    if (node.type != kernel::NodeType::kRevolute) continue;
    const auto is_large = [](double bound) {
      return std::isfinite(bound) && std::abs(bound) > kLargestAngle;
    };
    if (is_large(tree.lower[i]) || is_large(tree.upper[i])) return false;
  }
  return true;
}

// x of a joint's frame once it has turned: perpendicular to its axis and the
// next, or if these are parallel the x of before.
Vector3d CommonPerpendicular(const Vector3d& axis, const Vector3d& next,
                             const Vector3d& x) {
  const Vector3d across = axis.cross(next);
  const double sine = across.norm();
  return sine < kParallel ? x : Vector3d(across / sine);
}

}  // namespace

std::unique_ptr<const SerialArm> SerialArm::Create(
    const kernel::TreeLayout& tree) {
  if (!IsArm(tree)) return nullptr;
  const int n = tree.node_count;
  // The neutral pose; the last link is the tip, whose axis is the last joint's.
  std::vector<Link> links;
  Matrix3d rotation = Matrix3d::Identity();
  Vector3d origin = Vector3d::Zero();
  double length = 0;
  for (int i = 0; i < n; ++i) {
    const kernel::Node& node = tree.nodes[i];
    const Eigen::Map<const Vector3d> step(node.parent_from_rest_translation);
    origin += rotation * step;
    rotation = rotation * ConstMatrix3(node.parent_from_rest_rotation);
    if (i > 0) length += step.norm();
    links.push_back({rotation.col(2), origin});
  }
  const kernel::Task& task = tree.tasks[0];
  const Eigen::Map<const Vector3d> tool(task.node_from_effector_translation);
  length += tool.norm();
  const double size = length;  // without what joints slide
  links.push_back({links.back().axis, origin + rotation * tool});
  const Matrix3d tip =
      rotation * ConstMatrix3(task.node_from_effector_rotation);

  auto arm = std::unique_ptr<SerialArm>(new SerialArm);
  kernel::ArmLayout& layout = arm->layout_;
  layout.joint_count = n;
  layout.is_plain = true;
  Vector3d x = CommonPerpendicular(links[0].axis, links[1].axis,
                                   links[0].axis.unitOrthogonal());
  const auto frame = [&](int i) {
    Matrix3d axes;
    axes << x, links[i].axis.cross(x), links[i].axis;
    return axes;
  };
  RowMajor3(layout.base_from_first_rotation) = frame(0);
  Eigen::Map<Vector3d>(layout.base_from_first_translation) = links[0].origin;
  for (int i = 0; i < n; ++i) {
    const Link& link = links[i];
    const Link& next = links[i + 1];
    const Vector3d turned = CommonPerpendicular(link.axis, next.axis, x);
    layout.offset[i] =
        std::atan2(link.axis.dot(x.cross(turned)), x.dot(turned));
    x = turned;
    layout.cos_twist[i] = Snapped(link.axis.dot(next.axis), kRounding);
    layout.sin_twist[i] = Snapped(x.dot(link.axis.cross(next.axis)), kRounding);
    const Vector3d step = frame(i).transpose() * (next.origin - link.origin);
    layout.x[i] = SnappedToZero(step.x(), kRounding * size);
    layout.y[i] = SnappedToZero(step.y(), kRounding * size);
    layout.z[i] = SnappedToZero(step.z(), kRounding * size);
    const bool turns = tree.nodes[i].type == kernel::NodeType::kRevolute;
    const double stiffness = tree.columns[i].stiffness;
    layout.turn[i] = turns ? 1 : 0;
    layout.ease[i] = 1 / std::sqrt(stiffness);
    layout.is_plain = layout.is_plain && turns && stiffness == 1;
    arm->positions_[i] = tree.nodes[i].position;
    if (!turns) {
      length += std::max(std::abs(tree.lower[i]), std::abs(tree.upper[i]));
    }
  }
  const Matrix3d last_from_tip = frame(n - 1).transpose() * tip;
  RowMajor3(layout.last_from_tip_rotation) = last_from_tip;
  arm->tip_from_last_ =
      Eigen::Quaterniond(last_from_tip).normalized().conjugate();
  arm->length_ = length;
  arm->has_translation_ = task.row_begin == 0;
  arm->has_rotation_ = task.row_end == 6;
  return arm;
}

void SerialArm::Gather(const ConstVectorView& positions,
                       kernel::ArmRow& q) const {
  const int n = joint_count();
  for (int i = 0; i < n; ++i) q[i] = positions[positions_[i]];
  for (int i = n; i < kMaxArmJoints; ++i) q[i] = 0;
}

void SerialArm::Scatter(const kernel::ArmRow& q, VectorView positions) const {
  for (int i = 0; i < joint_count(); ++i) positions[positions_[i]] = q[i];
}

bool SerialArm::Takes(const kernel::ArmRow& q) const {
  for (int i = 0; i < joint_count(); ++i) {
    if (turns(i) && std::abs(q[i]) > kLargestAngle) return false;
  }
  return true;
}

void SerialArm::Prepare(const kernel::Settings& settings,
                        const kernel::TaskTarget& target,
                        kernel::ArmSettings& out) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const ConstMatrix3 world_from_base(settings.base_rotation);
  RowMajor3(out.world_from_first_rotation).noalias() =
      world_from_base * ConstMatrix3(layout_.base_from_first_rotation);
  Eigen::Map<Vector3d>(out.world_from_first_translation) =
      world_from_base *
          Eigen::Map<const Vector3d>(layout_.base_from_first_translation) +
      Eigen::Map<const Vector3d>(settings.base_translation);
  const int n = joint_count();
  for (int i = 0; i < kMaxArmJoints; ++i) {
    out.lower[i] = i < n ? settings.lower[i] : -kInfinity;
    out.upper[i] = i < n ? settings.upper[i] : kInfinity;
  }
  double scale[4] = {};  // three translations, the rotation
  for (int k = 0; k < 3; ++k) {
    out.translation_counts[k] = has_translation_ ? target.row_counts[k] : 0;
    if (has_translation_) scale[k] = target.row_scale[k];
  }
  if (has_rotation_) scale[3] = target.row_scale[3];
  const double largest = *std::max_element(scale, scale + 4);
  const double inverse = largest > 0 ? 1 / largest : 0;
  for (int k = 0; k < 3; ++k) out.translation_scale[k] = scale[k] * inverse;
  out.rotation_scale = scale[3] * inverse;
  out.is_plain = largest > 0 && *std::min_element(scale, scale + 4) == largest;
  out.position_tolerance2 = settings.position_tolerance2;
  out.rotation_tolerance2 = settings.rotation_tolerance2;
  out.max_iterations = settings.max_iterations;
  out.stop = settings.stop;
  out.stop_context = settings.stop_context;
}

void SerialArm::Prepare(const kernel::TaskTarget& target,
                        kernel::ArmTarget& out) const {
  RowMajor3(out.world_rotation).noalias() =
      ConstMatrix3(target.world_rotation) *
      ConstMatrix3(layout_.last_from_tip_rotation).transpose();
  for (int k = 0; k < 3; ++k) {
    out.world_translation[k] = target.world_translation[k];
  }
}

void SerialArm::Prepare(const GoalTarget& target,
                        kernel::ArmTarget& out) const {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vector3d translation = Vector3d::Zero();
  if (const auto* pose = std::get_if<RigidTransform>(&target)) {
    rotation = pose->rotation;
    translation = pose->translation;
  } else if (const auto* point = std::get_if<Vector3d>(&target)) {
    translation = *point;
  } else if (const auto* turn = std::get_if<Eigen::Quaterniond>(&target)) {
    rotation = *turn;
  }
  RowMajor3(out.world_rotation) =
      (rotation * tip_from_last_).toRotationMatrix();
  Eigen::Map<Vector3d>(out.world_translation) = translation;
}

void SerialArm::Clamp(const kernel::ArmSettings& settings,
                      kernel::ArmRow& q) const {
  for (int i = 0; i < joint_count(); ++i) {
    q[i] = std::clamp(q[i], settings.lower[i], settings.upper[i]);
  }
}

bool SerialArm::HasFreeSlide(const kernel::ArmSettings& settings) const {
  for (int i = 0; i < joint_count(); ++i) {
    const bool bounded =
        std::isfinite(settings.lower[i]) && std::isfinite(settings.upper[i]);
    if (!turns(i) && !bounded) return true;
  }
  return false;
}

bool SerialArm::IsOutOfReach(const kernel::ArmSettings& settings,
                             const kernel::ArmTarget& target) const {
  double distance2 = 0;
  for (int k = 0; k < 3; ++k) {
    const double way =
        target.world_translation[k] - settings.world_from_first_translation[k];
    distance2 += settings.translation_counts[k] * way * way;
  }
  const double reach = length_ + std::sqrt(settings.position_tolerance2);
  return distance2 > reach * reach;
}

}  // namespace gelenk
