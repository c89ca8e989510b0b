#include "convert/two_link.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "convert/geometry.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

Eigen::Vector2d InPlane(absl::string_view field, const v1::Vector3& point,
                        Violations& violations) {
  if (point.z() != 0) {
    violations.Add(absl::StrCat(field, ".z"),
                   absl::StrCat("want 0, got ", point.z()));
  }
  return {point.x(), point.y()};
}

Eigen::Vector3d InSpace(const Eigen::Vector2d& point) {
  return {point.x(), point.y(), 0};
}

// One lower and one upper bound, or none of both.
void SetLimits(const v1::JointLimits& proto, int k, TwoLinkProblem& problem,
               Violations& violations) {
  if (proto.lower_size() == 0 && proto.upper_size() == 0) return;
  if (proto.lower_size() != 1 || proto.upper_size() != 1) {
    violations.Add(absl::StrCat("limits[", k, "]"),
                   absl::StrFormat("want one lower and one upper bound, got %d "
                                   "and %d",
                                   proto.lower_size(), proto.upper_size()));
    return;
  }
  problem.lower_rad[k] = proto.lower(0);
  problem.upper_rad[k] = proto.upper(0);
}

}  // namespace

absl::StatusOr<TwoLinkProblem> FromProto(const v1::PlanarTwoLink& proto) {
  Violations violations;
  TwoLinkProblem problem;
  problem.base = InPlane("base", proto.base(), violations);
  problem.upper_length_m = proto.upper_length_m();
  problem.lower_length_m = proto.lower_length_m();
  problem.target = InPlane("target", proto.target(), violations);
  if (proto.current_angles_rad_size() == 2) {
    problem.current_rad = {proto.current_angles_rad(0),
                           proto.current_angles_rad(1)};
  } else if (proto.current_angles_rad_size() != 0) {
    violations.Add(
        "current_angles_rad",
        absl::StrCat("want none or 2, got ", proto.current_angles_rad_size()));
  }
  if (proto.limits_size() == 2) {
    for (int k = 0; k < 2; ++k) {
      SetLimits(proto.limits(k), k, problem, violations);
    }
  } else if (proto.limits_size() != 0) {
    violations.Add("limits",
                   absl::StrCat("want none or 2, got ", proto.limits_size()));
  }
  violations.AddStatus("", CheckTwoLink(problem));
  if (!violations.empty()) return violations.ToStatus();
  return problem;
}

absl::StatusOr<TwoBoneProblem> FromProto(const v1::TwoBoneLimb& proto) {
  TwoBoneProblem problem;
  problem.world_root = FromProto(proto.world_root());
  problem.world_mid = FromProto(proto.world_mid());
  problem.world_tip = FromProto(proto.world_tip());
  problem.world_target = FromProto(proto.world_target());
  if (proto.has_world_pole())
    problem.world_pole = FromProto(proto.world_pole());
  problem.swivel_rad = proto.swivel_rad();
  problem.soft_distance_m = proto.soft_distance_m();
  // 0, as an unset number reads, means none.
  if (proto.max_stretch() != 0) problem.max_stretch = proto.max_stretch();
  if (absl::Status status = CheckTwoBone(problem); !status.ok()) return status;
  return problem;
}

void ToProto(const TwoLinkAnswer& answer, v1::SolveTwoLinkResponse* proto) {
  for (int i = 0; i < answer.solution_count; ++i) {
    const TwoLinkSolution& solution = answer.solutions[i];
    v1::TwoLinkSolution* out = proto->add_solutions();
    out->add_angles_rad(solution.angles_rad[0]);
    out->add_angles_rad(solution.angles_rad[1]);
    ToProto(InSpace(solution.mid), out->mutable_world_mid());
    ToProto(InSpace(solution.tip), out->mutable_world_tip());
    out->set_within_limits(solution.within_limits);
    out->set_change_rad(solution.change_rad);
  }
  proto->set_best(answer.best);
  proto->set_unreachable(answer.unreachable);
  proto->set_distance_m(answer.distance_m);
  proto->set_min_reach_m(answer.min_reach_m);
  proto->set_max_reach_m(answer.max_reach_m);
  proto->set_stretch(1);
}

void ToProto(const TwoBoneAnswer& answer, v1::SolveTwoLinkResponse* proto) {
  for (int i = 0; i < answer.solution_count; ++i) {
    const TwoBoneSolution& solution = answer.solutions[i];
    v1::TwoLinkSolution* out = proto->add_solutions();
    ToProto(solution.world_root_rotation, out->mutable_world_root_rotation());
    ToProto(solution.world_mid_rotation, out->mutable_world_mid_rotation());
    ToProto(solution.world_mid, out->mutable_world_mid());
    ToProto(solution.world_tip, out->mutable_world_tip());
    out->set_within_limits(true);
  }
  proto->set_unreachable(answer.unreachable);
  proto->set_distance_m(answer.distance_m);
  proto->set_min_reach_m(answer.min_reach_m);
  proto->set_max_reach_m(answer.max_reach_m);
  proto->set_stretch(answer.stretch);
}

}  // namespace gelenk::convert
