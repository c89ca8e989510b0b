#include "gelenk/kinematics/dh_table.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

RigidTransform Turn(double angle, const Vector3d& axis) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), Vector3d::Zero()};
}

RigidTransform Move(double x, double z) {
  return {Eigen::Quaterniond::Identity(), Vector3d(x, 0, z)};
}

RigidTransform AboutX(const DhRow& row) {
  return Turn(row.alpha_rad, Vector3d::UnitX()) * Move(row.a_m, 0);
}

RigidTransform AboutZ(const DhRow& row) {
  return Turn(row.theta_rad, Vector3d::UnitZ()) * Move(0, row.d_m);
}

bool FitsARow(JointType type) {
  return type == JointType::kRevolute || type == JointType::kPrismatic ||
         type == JointType::kFixed;
}

// A line in space; `direction` is unit.
struct Line {
  Vector3d point;
  Vector3d direction;
};

// The frame on `axis` towards `next`; `before` is the frame before it.
struct AxisFrame {
  Vector3d origin;
  Vector3d x;
  Vector3d z;
};

// Any unit vector across `z`, the same for the same z.
Vector3d Across(const Vector3d& z) {
  int least = 0;
  z.cwiseAbs().minCoeff(&least);
  return z.cross(Vector3d::Unit(least)).normalized();
}

AxisFrame FrameTowards(const Line& axis, const Line& next,
                       const AxisFrame* before) {
  const Vector3d& z = axis.direction;
  const Vector3d cross = z.cross(next.direction);
  const Vector3d between = next.point - axis.point;
  const double sine = cross.norm();
  if (sine < kParallel) {
    // The perpendicular through the frame before, where its axis leads there.
    const Vector3d start = before ? before->origin : axis.point;
    const Vector3d origin = axis.point + z * z.dot(start - axis.point);
    Vector3d away = next.point - origin;
    away -= z * z.dot(away);
    const double scale = 1 + between.norm();
    if (away.norm() > 1e-12 * scale) return {origin, away.normalized(), z};
    Vector3d x = before ? before->x : Across(z);
    x -= z * z.dot(x);
    return {origin, x.norm() > 0.5 ? x.normalized() : Across(z), z};
  }
  const Vector3d normal = cross / sine;
  // Where the perpendicular leaves `axis`.
  const double along = between.cross(next.direction).dot(normal) / sine;
  const double distance = between.dot(normal);
  return {axis.point + along * z, distance < 0 ? Vector3d(-normal) : normal, z};
}

// Signed angle from `from` to `to` about `axis`, all unit, both across it.
double AngleAbout(const Vector3d& axis, const Vector3d& from,
                  const Vector3d& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to));
}

RigidTransform Pose(const AxisFrame& frame) {
  Eigen::Matrix3d m;
  m << frame.x, frame.z.cross(frame.x), frame.z;
  return {Eigen::Quaterniond(m).normalized(), frame.origin};
}

// What leads from one frame to the next: about and along the first one's x,
// then about and along the second one's z.
void SetAcross(const AxisFrame& from, const AxisFrame& to, DhRow& row) {
  row.a_m = from.x.dot(to.origin - from.origin);
  row.alpha_rad = AngleAbout(from.x, from.z, to.z);
}
void SetAlong(const AxisFrame& from, const AxisFrame& to, DhRow& row) {
  row.d_m = to.z.dot(to.origin - from.origin);
  row.theta_rad = AngleAbout(to.z, from.x, to.x);
}

absl::Status Refused(absl::string_view field, absl::string_view what) {
  Violations violations;
  violations.Add(field, what);
  return violations.ToStatus();
}

// Indices of the joints from the base to `tip`, or what is wrong.
absl::StatusOr<std::vector<int>> Path(const Skeleton& skeleton,
                                      absl::string_view base_joint_id,
                                      int tip) {
  int base = 0;
  while (skeleton.span(base).parent >= 0) base = skeleton.span(base).parent;
  if (!base_joint_id.empty()) {
    base = skeleton.FindJoint(base_joint_id);
    if (base < 0) {
      return Refused("base_joint_id",
                     absl::StrCat("no joint ", QuotedId(base_joint_id)));
    }
  }
  std::vector<int> path;
  for (int i = tip; i >= 0; i = skeleton.span(i).parent) {
    path.push_back(i);
    if (i == base) {
      std::reverse(path.begin(), path.end());
      return path;
    }
  }
  return Refused("base_joint_id", absl::StrCat(QuotedId(base_joint_id),
                                               " is not above the effector"));
}

absl::Status CheckJoint(const Joint& joint) {
  if (!FitsARow(joint.type)) {
    return Refused("end_effector_id",
                   absl::StrCat("joint ", QuotedId(joint.id), " is ",
                                JointTypeName(joint.type),
                                ": a table takes revolute, prismatic and fixed "
                                "joints"));
  }
  if (joint.mimic) {
    return Refused("end_effector_id",
                   absl::StrCat("joint ", QuotedId(joint.id),
                                " mimics another: a table cannot say that"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<SkeletonBuilder> BuilderOf(const DhTable& given) {
  DhTable table = given;
  Violations violations;
  if (table.rows.empty()) violations.Add("rows", "want at least one");
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const DhRow& row = table.rows[i];
    const std::string field = absl::StrCat("rows[", i, "]");
    CheckNumber(absl::StrCat(field, ".a_m"), row.a_m, violations);
    CheckNumber(absl::StrCat(field, ".alpha_rad"), row.alpha_rad, violations);
    CheckNumber(absl::StrCat(field, ".d_m"), row.d_m, violations);
    CheckNumber(absl::StrCat(field, ".theta_rad"), row.theta_rad, violations);
    if (!FitsARow(row.type)) {
      violations.Add(absl::StrCat(field, ".type"),
                     absl::StrCat("want revolute, prismatic or fixed, got ",
                                  JointTypeName(row.type)));
    }
  }
  CheckAndNormalize("world_from_base", table.world_from_base, violations);
  CheckAndNormalize("last_from_tool", table.last_from_tool, violations);
  if (!violations.empty()) return violations.ToStatus();

  SkeletonBuilder builder;
  std::string parent;
  RigidTransform offset = table.world_from_base;
  for (size_t i = 0; i < table.rows.size(); ++i) {
    const DhRow& row = table.rows[i];
    const bool modified = table.convention == DhConvention::kModified;
    Joint joint;
    joint.id = absl::StrCat("j", i);
    joint.parent_id = parent;
    joint.type = row.type;
    joint.axis = Vector3d::UnitZ();
    joint.limits = row.limits;
    // q turns about, or moves along, the z that theta and d belong to, and may
    // come before or after them.
    joint.parent_from_joint =
        modified ? offset * AboutX(row) * AboutZ(row) : offset;
    offset = modified ? RigidTransform() : AboutZ(row) * AboutX(row);
    builder.AddJoint(joint);
    parent = joint.id;
  }
  builder.AddEndEffector({"tip", parent, offset * table.last_from_tool});
  return builder;
}

absl::StatusOr<DhTable> ToDhTable(const Skeleton& skeleton,
                                  absl::string_view base_joint_id,
                                  absl::string_view end_effector_id,
                                  DhConvention convention) {
  const std::optional<EffectorFrame> effector =
      skeleton.FindEffector(end_effector_id);
  if (!effector) {
    return Refused("end_effector_id", absl::StrCat("no end effector or joint ",
                                                   QuotedId(end_effector_id)));
  }
  absl::StatusOr<std::vector<int>> path =
      Path(skeleton, base_joint_id, effector->joint);
  if (!path.ok()) return path.status();

  WorldTransforms frames;
  ForwardKinematics(skeleton, NeutralPositions(skeleton), frames);
  DhTable table;
  table.convention = convention;
  std::vector<Line> axes;
  for (int i : *path) {
    const Joint& joint = skeleton.joint(i);
    if (absl::Status status = CheckJoint(joint); !status.ok()) return status;
    if (joint.type == JointType::kFixed) continue;
    DhRow row;
    row.type = joint.type;
    row.limits = joint.limits;
    table.rows.push_back(row);
    axes.push_back({frames[i].translation,
                    (frames[i].rotation * joint.axis).normalized()});
  }
  if (axes.empty()) {
    return Refused("end_effector_id", "no joint on the way to it moves");
  }
  // One frame an axis, towards the next; the last stands as the one before it.
  const int count = static_cast<int>(axes.size());
  std::vector<AxisFrame> on_axis;
  for (int i = 0; i < count; ++i) {
    const AxisFrame* before = i > 0 ? &on_axis[i - 1] : nullptr;
    if (i + 1 < count) {
      on_axis.push_back(FrameTowards(axes[i], axes[i + 1], before));
      continue;
    }
    if (before == nullptr) {
      on_axis.push_back(
          {axes[i].point, Across(axes[i].direction), axes[i].direction});
      continue;
    }
    const Vector3d& z = axes[i].direction;
    // The foot of the perpendicular that comes from the axis before.
    const AxisFrame back = FrameTowards(axes[i - 1], axes[i], before);
    const Vector3d foot =
        axes[i].point +
        z * z.dot(back.origin +
                  back.x * back.x.dot(axes[i].point - back.origin) -
                  axes[i].point);
    on_axis.push_back({foot, before->x, z});
  }
  const RigidTransform world_from_tool =
      frames[effector->joint] * effector->joint_from_effector;
  table.world_from_base = Pose(on_axis[0]);
  if (convention == DhConvention::kModified) {
    for (int i = 1; i < count; ++i) {
      SetAcross(on_axis[i - 1], on_axis[i], table.rows[i]);
      SetAlong(on_axis[i - 1], on_axis[i], table.rows[i]);
    }
  } else {
    // Row i turns about axis i, then leads across to axis i + 1.
    for (int i = 0; i + 1 < count; ++i) {
      if (i > 0) SetAlong(on_axis[i - 1], on_axis[i], table.rows[i]);
      SetAcross(on_axis[i], on_axis[i + 1], table.rows[i]);
    }
    if (count > 1) {
      SetAlong(on_axis[count - 2], on_axis[count - 1], table.rows[count - 1]);
    }
  }
  table.last_from_tool = Pose(on_axis[count - 1]).Inverse() * world_from_tool;
  return table;
}

}  // namespace gelenk
