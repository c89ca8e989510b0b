#include "gelenk/skeleton/planar_chain.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/base/violations.h"

namespace gelenk {
namespace {

RigidTransform Translation(double x, double y) {
  RigidTransform result;
  result.translation = {x, y, 0};
  return result;
}

absl::Status Check(const PlanarChain& chain) {
  Violations violations;
  if (chain.link_lengths_m.empty()) {
    violations.Add("link_lengths", "want at least one");
  }
  for (size_t i = 0; i < chain.link_lengths_m.size(); ++i) {
    CheckPositive(absl::StrCat("link_lengths[", i, "]"),
                  chain.link_lengths_m[i], violations);
  }
  CheckNumbers("base", chain.base, violations);
  if (!chain.limits.empty() &&
      chain.limits.size() != chain.link_lengths_m.size()) {
    violations.Add("limits", absl::StrFormat("want none or %d, got %d",
                                             chain.link_lengths_m.size(),
                                             chain.limits.size()));
  }
  return violations.ToStatus();
}

}  // namespace

absl::StatusOr<SkeletonBuilder> BuilderOf(const PlanarChain& chain) {
  if (absl::Status status = Check(chain); !status.ok()) return status;
  SkeletonBuilder builder;
  builder.SetPlanar(true);
  std::string parent;
  RigidTransform offset = Translation(chain.base.x(), chain.base.y());
  if (chain.movable_base) {
    const Eigen::Vector3d axes[] = {Eigen::Vector3d::UnitX(),
                                    Eigen::Vector3d::UnitY()};
    const char* const ids[] = {"base_x", "base_y"};
    for (int k = 0; k < 2; ++k) {
      Joint joint;
      joint.id = ids[k];
      joint.parent_id = parent;
      joint.type = JointType::kPrismatic;
      joint.parent_from_joint = offset;
      joint.axis = axes[k];
      builder.AddJoint(joint);
      parent = joint.id;
      offset = {};
    }
  }
  for (size_t i = 0; i < chain.link_lengths_m.size(); ++i) {
    Joint joint;
    joint.id = absl::StrCat("j", i);
    joint.parent_id = parent;
    joint.type = JointType::kRevolute;
    joint.parent_from_joint = offset;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.link_length_m = chain.link_lengths_m[i];
    if (!chain.limits.empty()) joint.limits = chain.limits[i];
    builder.AddJoint(joint);
    parent = joint.id;
    offset = Translation(chain.link_lengths_m[i], 0);
  }
  builder.AddEndEffector({"tip", parent, offset});
  return builder;
}

}  // namespace gelenk
