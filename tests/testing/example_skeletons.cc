#include "tests/testing/example_skeletons.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::testing {
namespace {

// A row of a modified Denavit-Hartenberg table without its variable, and the
// range of that.
struct ArmRow {
  double a_m;
  double d_m;
  // In quarter turns.
  int alpha_quarters;
  double lower_rad;
  double upper_rad;
};

// Modified rows: about X by alpha, then (a, 0, d) in the turned frame.
RigidTransform RestOffset(const ArmRow& row) {
  const double half = row.alpha_quarters * M_PI / 4;
  const Eigen::Quaterniond turn =
      QuaternionXyzw(std::sin(half), 0, 0, std::cos(half));
  return {turn, turn * Eigen::Vector3d(row.a_m, 0, row.d_m)};
}

Joint RevoluteAboutZ(int index, const RigidTransform& parent_from_joint) {
  Joint joint;
  joint.id = absl::StrCat("j", index);
  if (index > 0) joint.parent_id = absl::StrCat("j", index - 1);
  joint.type = JointType::kRevolute;
  joint.axis = Eigen::Vector3d::UnitZ();
  joint.parent_from_joint = parent_from_joint;
  return joint;
}

RigidTransform Translation(double x, double y, double z) {
  return {Eigen::Quaterniond::Identity(), {x, y, z}};
}

}  // namespace

std::shared_ptr<const Skeleton> PlanarChain(
    const Eigen::Vector3d& base, const std::vector<double>& link_lengths_m) {
  SkeletonBuilder builder;
  RigidTransform rest_offset = Translation(base.x(), base.y(), base.z());
  const int count = static_cast<int>(link_lengths_m.size());
  for (int i = 0; i < count; ++i) {
    builder.AddJoint(RevoluteAboutZ(i, rest_offset));
    rest_offset = Translation(link_lengths_m[i], 0, 0);
  }
  builder.AddEndEffector({"tip", absl::StrCat("j", count - 1), rest_offset});
  return builder.Build().value();
}

std::shared_ptr<const Skeleton> PandaArm() {
  // Franka Emika, "Robot and interface specifications".
  const std::vector<ArmRow> rows = {
      {0, 0.333, 0, -2.8973, 2.8973},        {0, 0, -1, -1.7628, 1.7628},
      {0, 0.316, 1, -2.8973, 2.8973},        {0.0825, 0, 1, -3.0718, -0.0698},
      {-0.0825, 0.384, -1, -2.8973, 2.8973}, {0, 0, 1, -0.0175, 3.7525},
      {0.088, 0, 1, -2.8973, 2.8973}};
  SkeletonBuilder builder;
  for (size_t i = 0; i < rows.size(); ++i) {
    Joint joint = RevoluteAboutZ(static_cast<int>(i), RestOffset(rows[i]));
    joint.limits.lower = {rows[i].lower_rad};
    joint.limits.upper = {rows[i].upper_rad};
    builder.AddJoint(joint);
  }
  builder.AddEndEffector({"tip", "j6", Translation(0, 0, 0.107)});
  return builder.Build().value();
}

std::shared_ptr<const Skeleton> Ur5Arm() {
  // Universal Robots, "DH parameters": standard rows, along and about Z, then
  // along and about X; so what follows a joint is the offset of the next.
  struct StandardRow {
    double a_m, d_m;
    int alpha_quarters;
  };
  const std::vector<StandardRow> rows = {{0, 0.089159, 1}, {-0.425, 0, 0},
                                         {-0.39225, 0, 0}, {0, 0.10915, 1},
                                         {0, 0.09465, -1}, {0, 0.0823, 0}};
  SkeletonBuilder builder;
  RigidTransform offset;
  for (size_t i = 0; i < rows.size(); ++i) {
    Joint joint = RevoluteAboutZ(static_cast<int>(i), offset);
    joint.limits.lower = {-2 * M_PI};
    joint.limits.upper = {2 * M_PI};
    builder.AddJoint(joint);
    const double half = rows[i].alpha_quarters * M_PI / 4;
    offset.rotation = QuaternionXyzw(std::sin(half), 0, 0, std::cos(half));
    offset.translation = {rows[i].a_m, 0, rows[i].d_m};
  }
  builder.AddEndEffector({"tip", "j5", offset});
  return builder.Build().value();
}

}  // namespace gelenk::testing
