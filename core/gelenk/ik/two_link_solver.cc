#include "gelenk/ik/two_link_solver.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/ik/on_limit.h"
#include "gelenk/ik/solve_diagnosis.h"
#include "gelenk/ik/two_link.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Axes whose directions differ by less than this are parallel, rad.
constexpr double kParallel = 1e-9;
// Shorter links are none, m.
constexpr double kLeastLength_m = 1e-9;

// The two links, drawn with both joints at zero in a frame at the first joint
// whose z is its axis: there the second turns about `sense` times z.
struct Links {
  int first_joint = -1;
  int second_joint = -1;
  RigidTransform skeleton_from_plane;
  Vector2d upper;
  Vector2d lower;
  // Of the effector above the first joint's plane.
  double height_m = 0;
  double sense = 1;
};

absl::StatusOr<Links> LinksOf(const IkProblem& problem) {
  const Skeleton& skeleton = problem.skeleton();
  const EffectorFrame effector =
      *skeleton.FindEffector(EffectorId(problem.goals()[0].kind));
  Links links;
  RigidTransform first_from_second;
  // Carries from the effector to what has been passed so far.
  RigidTransform passed = effector.joint_from_effector;
  Vector3d tip = Vector3d::Zero();
  for (int j = effector.joint; j >= 0; j = skeleton.span(j).parent) {
    const Joint& joint = skeleton.joint(j);
    if (joint.type != JointType::kFixed) {
      if (joint.type != JointType::kRevolute || joint.mimic) {
        return absl::InvalidArgumentError(absl::StrCat(
            "joint ", QuotedId(joint.id), " is no revolute joint of its own"));
      }
      if (links.first_joint >= 0) {
        return absl::InvalidArgumentError(absl::StrCat(
            "joint ", QuotedId(joint.id), " is one more than two that move ",
            QuotedId(EffectorId(problem.goals()[0].kind))));
      }
      if (links.second_joint < 0) {
        links.second_joint = j;
        tip = passed.translation;
      } else {
        links.first_joint = j;
        first_from_second = passed;
      }
      passed = RigidTransform();
    }
    passed = joint.parent_from_joint * passed;
  }
  if (links.first_joint < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("want two joints that move ",
                     QuotedId(EffectorId(problem.goals()[0].kind))));
  }
  const Vector3d& axis = skeleton.joint(links.first_joint).axis;
  const Vector3d other =
      first_from_second.rotation * skeleton.joint(links.second_joint).axis;
  if (axis.cross(other).norm() > kParallel) {
    return absl::InvalidArgumentError(absl::StrCat(
        "the axes of ", QuotedId(skeleton.joint(links.first_joint).id), " and ",
        QuotedId(skeleton.joint(links.second_joint).id), " are not parallel"));
  }
  links.sense = axis.dot(other) > 0 ? 1 : -1;
  const Eigen::Quaterniond joint_from_plane =
      ShortestRotation(Vector3d::UnitZ(), axis);
  links.skeleton_from_plane =
      passed * RigidTransform{joint_from_plane, Vector3d::Zero()};
  const Vector3d upper =
      joint_from_plane.conjugate() * first_from_second.translation;
  const Vector3d lower =
      joint_from_plane.conjugate() * (first_from_second.rotation * tip);
  links.upper = upper.head<2>();
  links.lower = lower.head<2>();
  links.height_m = upper.z() + lower.z();
  if (links.upper.norm() < kLeastLength_m ||
      links.lower.norm() < kLeastLength_m) {
    return absl::InvalidArgumentError("a link has no length");
  }
  return links;
}

absl::Status Fits(const IkProblem& problem) {
  if (problem.goals().size() != 1) {
    return absl::InvalidArgumentError("want one goal");
  }
  const auto* position = std::get_if<PositionGoal>(&problem.goals()[0].kind);
  if (position == nullptr || position->axes.count() != 3) {
    return absl::InvalidArgumentError("want a position goal, along all axes");
  }
  return LinksOf(problem).status();
}

double AngleOf(const Vector2d& v) { return std::atan2(v.y(), v.x()); }

// The two joints' numbers and the angles of the closed form: the first against
// the plane's x, the second against the first link.
class Angles {
 public:
  Angles(const Skeleton& skeleton, const Links& links)
      : bounds_(skeleton.position_bounds()),
        first_(skeleton.span(links.first_joint).position_offset),
        second_(skeleton.span(links.second_joint).position_offset),
        sense_(links.sense),
        offset_(AngleOf(links.upper),
                AngleOf(links.lower) - AngleOf(links.upper)) {}

  Vector2d Of(const ConstVectorView& positions) const {
    return {positions[first_] + offset_[0],
            sense_ * positions[second_] + offset_[1]};
  }
  Vector2d Lower() const {
    return {bounds_.lower[first_] + offset_[0], Second(true) + offset_[1]};
  }
  Vector2d Upper() const {
    return {bounds_.upper[first_] + offset_[0], Second(false) + offset_[1]};
  }
  void Put(const Vector2d& angles_rad, VectorView positions) const {
    positions[first_] = angles_rad[0] - offset_[0];
    positions[second_] = sense_ * (angles_rad[1] - offset_[1]);
  }

 private:
  double Second(bool lower) const {
    const bool takes_lower = lower == (sense_ > 0);
    return sense_ *
           (takes_lower ? bounds_.lower[second_] : bounds_.upper[second_]);
  }

  const PositionBounds& bounds_;
  int first_;
  int second_;
  double sense_;
  Vector2d offset_;
};

// Moves the two joints; returns what keeps them, and how far they stay away.
SolveOutcome Reach(const IkProblem& problem, const Links& links,
                   double tolerance_m, VectorView positions,
                   double& distance_m) {
  const double* t = problem.targets()[0].world_translation;
  const Vector3d plane_target =
      (problem.world_from_skeleton() * links.skeleton_from_plane).Inverse() *
      Vector3d(t[0], t[1], t[2]);
  const Angles angles(problem.skeleton(), links);
  TwoLinkProblem planar;
  planar.upper_length_m = links.upper.norm();
  planar.lower_length_m = links.lower.norm();
  planar.target = plane_target.head<2>();
  planar.current_rad = angles.Of(positions);
  planar.lower_rad = angles.Lower();
  planar.upper_rad = angles.Upper();
  const TwoLinkAnswer answer = SolveTwoLink(planar);
  angles.Put(answer.solutions[answer.best].angles_rad, positions);
  // The angles are clamped for the rounding of what was added to them.
  ClampToLimits(problem.skeleton(), positions);
  const double across = std::abs(plane_target.z() - links.height_m);
  distance_m = std::hypot(answer.distance_m, across);
  if (distance_m <= tolerance_m) return SolveOutcome::kConverged;
  const bool out_of_reach = answer.unreachable || across > tolerance_m;
  return out_of_reach ? SolveOutcome::kUnreachable
                      : SolveOutcome::kStalledAtLimits;
}

}  // namespace

absl::Status TwoLinkSolver::Check(const IkProblem& problem) {
  const absl::Status fits = Fits(problem);
  if (fits.ok()) return fits;
  Violations violations;
  violations.Add("method", absl::StrCat("two-link: ", fits.message()));
  return violations.ToStatus();
}

void TwoLinkSolver::Solve(const IkProblem& problem,
                          const SolverOptions& options, VectorView positions,
                          SolveReport& report) {
  const Skeleton& skeleton = problem.skeleton();
  const Links links = *LinksOf(problem);
  report.outcome = SolveOutcome::kConverged;
  report.iteration_count = 0;
  report.restart_count = 0;
  report.position_errors_m.assign(1, 0);
  report.rotation_errors_rad.assign(1, 0);
  report.limited_joints.clear();
  report.change = 0;
  start_ = positions;
  ClampToLimits(skeleton, positions);
  if (problem.targets()[0].active) {
    report.outcome = Reach(problem, links, options.position_tolerance_m,
                           positions, report.position_errors_m[0]);
  }
  if (options.detail == ReportDetail::kBrief) return;
  for (int joint : {links.first_joint, links.second_joint}) {
    if (IsOnLimit(skeleton, joint, positions)) {
      report.limited_joints.push_back(joint);
    }
  }
  change_.resize(skeleton.velocity_count());
  report.change = WeightedChange(problem, start_, positions, change_);
  if (options.detail == ReportDetail::kDiagnosis) {
    Diagnose(problem, positions, report);
  }
}

}  // namespace gelenk
