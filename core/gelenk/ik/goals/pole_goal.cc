#include "gelenk/ik/goals/pole_goal.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "gelenk/ik/goals/frame_rows.h"
#include "gelenk/ik/goals/goal_check.h"
#include "gelenk/ik/goals/pose_rows.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

// Of the limb's length: a shorter bend, span or distance of the pole from the
// axis has no direction to rely on, and fades out. A limb of two equal bones
// has it at 2 degrees.
constexpr double kPoleBlur = 0.01;
// Of the limb's length: the bend that the pole asks of a straight limb.
constexpr double kNudge = 1e-3;
// Whatever the skeleton, shorter limbs than this are points.
constexpr double kLeastLimb_m = 1e-6;

// -1, and a violation, when there is none.
int FindJoint(const Skeleton& skeleton, absl::string_view field,
              absl::string_view id, Violations& violations) {
  const int joint = skeleton.FindJoint(id);
  if (joint < 0) {
    violations.Add(field, absl::StrCat("no joint ", QuotedId(id)));
  }
  return joint;
}

bool IsBelow(const Skeleton& skeleton, int joint, int ancestor) {
  do {
    joint = skeleton.span(joint).parent;
  } while (joint > ancestor);  // Parents come first.
  return joint == ancestor;
}

// A direction normal to the limb's axis, and how sure it is.
struct Radius {
  Eigen::Vector3d direction;
  double length;
  // How far along the axis it stands.
  double axial;
};

Radius RadiusOf(const Eigen::Vector3d& from_root, const Eigen::Vector3d& axis) {
  Radius radius;
  radius.axial = from_root.dot(axis);
  const Eigen::Vector3d across = from_root - radius.axial * axis;
  radius.length = across.norm();
  radius.direction = radius.length > 0 ? Eigen::Vector3d(across / radius.length)
                                       : Eigen::Vector3d::Zero();
  return radius;
}

struct Limb {
  Eigen::Vector3d axis;  // from root to tip; zero when they coincide
  double span;           // their distance
  double length;         // of both bones
  Radius bend;           // of the middle
  Radius pole;
};

Limb LimbAt(const Eigen::Vector3d& root, const Eigen::Vector3d& mid,
            const Eigen::Vector3d& tip, const Eigen::Vector3d& point) {
  Limb limb;
  limb.span = (tip - root).norm();
  limb.length = (mid - root).norm() + (tip - mid).norm();
  limb.axis = limb.span > 0 ? Eigen::Vector3d((tip - root) / limb.span)
                            : Eigen::Vector3d::Zero();
  limb.bend = RadiusOf(mid - root, limb.axis);
  limb.pole = RadiusOf(point - root, limb.axis);
  return limb;
}

// 1 / length, cut off where a limb's direction is about to vanish.
double SafeInverse(double length, double blur) {
  return 1 / std::sqrt(length * length + blur * blur);
}

// Row 0: the angle from the bend to the pole about the limb's axis, which moves
// with the root and the tip.
void StoreTurn(const Limb& limb, kernel::GoalRows& rows) {
  const double blur = kPoleBlur * std::max(limb.length, kLeastLimb_m);
  const double per_bend = SafeInverse(limb.bend.length, blur);
  const double per_pole = SafeInverse(limb.pole.length, blur);
  const double per_span = SafeInverse(limb.span, blur);
  // Each is 1 but where its direction is lost.
  const double fade = limb.bend.length * per_bend * limb.pole.length *
                      per_pole * limb.span * per_span;
  const Eigen::Vector3d& b = limb.bend.direction;
  const Eigen::Vector3d& p = limb.pole.direction;
  const double angle = std::atan2(limb.axis.dot(b.cross(p)), b.dot(p));
  rows.residual[0] = fade * 2 * std::sin(0.5 * angle);
  rows.position_error2 = 0;
  rows.rotation_error2 = rows.residual[0] * rows.residual[0];
  rows.rotation_energy = AngleEnergy(rows.rotation_error2);

  // How the angle closes as the bend and the pole move, short of the factor
  // that the span brings.
  const Eigen::Vector3d bend_rate =
      per_bend * limb.pole.length * per_pole * limb.axis.cross(b);
  const Eigen::Vector3d pole_rate =
      per_pole * limb.bend.length * per_bend * limb.axis.cross(p);
  const Eigen::Vector3d at_bend = limb.span * per_span * bend_rate;
  const Eigen::Vector3d at_pole = limb.span * per_span * pole_rate;
  // What the tip does to the axis.
  const Eigen::Vector3d at_tip =
      per_span * (limb.pole.axial * pole_rate - limb.bend.axial * bend_rate);
  VelocityRow(rows, 0, 0) = at_pole - at_bend - at_tip;
  VelocityRow(rows, 1, 0) = at_bend;
  VelocityRow(rows, 2, 0) = at_tip;
}

// Row 1: a straight limb has no bend that could turn; this is how it gets one,
// on the pole's side. Small enough to be far inside any tolerance where the
// limb must be straight to reach.
void StoreNudge(const Limb& limb, kernel::GoalRows& rows) {
  const double length = std::max(limb.length, kLeastLimb_m);
  const double blur = kPoleBlur * length;
  const double bend = limb.bend.length / blur;
  const double fade = 1 / (1 + bend * bend);
  const Eigen::Vector3d& p = limb.pole.direction;
  const double towards_pole =
      limb.bend.direction.dot(p) * limb.bend.length / length;
  const double missing = kNudge - towards_pole;
  const bool counts =
      missing > 0 && limb.pole.length > blur && limb.span > blur;
  rows.residual[1] = counts ? fade * missing : 0;
  rows.rotation_energy += 0.5 * rows.residual[1] * rows.residual[1];
  if (!counts) return;
  const Eigen::Vector3d at_bend = fade / length * p;
  const Eigen::Vector3d at_tip = -limb.bend.axial / limb.span * at_bend;
  VelocityRow(rows, 0, 1) = -at_bend - at_tip;
  VelocityRow(rows, 1, 1) = at_bend;
  VelocityRow(rows, 2, 1) = at_tip;
}

}  // namespace

void CheckAndNormalize(PoleGoal& goal, Violations& violations) {
  CheckNumbers("world_point", goal.world_point, violations);
}

void CheckOn(const Skeleton& skeleton, PoleGoal& goal, Violations& violations) {
  const int root =
      FindJoint(skeleton, "root_joint_id", goal.root_joint_id, violations);
  const int mid =
      FindJoint(skeleton, "mid_joint_id", goal.mid_joint_id, violations);
  const int tip =
      FindJoint(skeleton, "tip_joint_id", goal.tip_joint_id, violations);
  if (root >= 0 && mid >= 0 && !IsBelow(skeleton, mid, root)) {
    violations.Add("mid_joint_id",
                   absl::StrCat(QuotedId(goal.mid_joint_id), " is not below ",
                                QuotedId(goal.root_joint_id)));
  }
  if (mid >= 0 && tip >= 0 && !IsBelow(skeleton, tip, mid)) {
    violations.Add("tip_joint_id",
                   absl::StrCat(QuotedId(goal.tip_joint_id), " is not below ",
                                QuotedId(goal.mid_joint_id)));
  }
}

EffectorTask TaskOf(const Skeleton& skeleton, const PoleGoal& goal) {
  EffectorTask task = TaskOnEffector(skeleton, goal.root_joint_id,
                                     kernel::GoalShape::kPole, 0, 2);
  // Origins of joints, also where an end effector has the id of a joint.
  task.frame_count = 3;
  const std::string* ids[] = {&goal.root_joint_id, &goal.mid_joint_id,
                              &goal.tip_joint_id};
  for (int f = 0; f < 3; ++f) {
    task.frames[f] = {skeleton.FindJoint(*ids[f]), {}};
  }
  return task;
}

void StoreTarget(const PoleGoal& goal, kernel::TaskTarget& target) {
  Store(goal.world_point, target.world_translation);
}

void StoreRows(const PoleGoal&, double weight, kernel::TaskTarget& target) {
  StoreScales(kernel::GoalShape::kPole, 0, 2, 1, weight, target);
}

void LinearizePole(const kernel::TaskTarget& target,
                   const kernel::GoalFrame* frames, kernel::GoalRows& rows) {
  const Limb limb =
      LimbAt(View(frames[0].translation), View(frames[1].translation),
             View(frames[2].translation), View(target.world_translation));
  for (int f = 0; f < 3; ++f) {
    for (int r = 0; r < 2; ++r) {
      VelocityRow(rows, f, r).setZero();
      AngularRow(rows, f, r).setZero();
    }
  }
  StoreTurn(limb, rows);
  StoreNudge(limb, rows);
}

}  // namespace gelenk
