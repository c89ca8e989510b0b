#include "gelenk/skeleton/joint_check.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/base/number_check.h"
#include "gelenk/math/rotation.h"

namespace gelenk {
namespace {

constexpr double kMaxTwist = 2 * std::numbers::pi;

void CheckUnit(absl::string_view field, Eigen::Vector3d& direction,
               Violations& violations) {
  const double norm = direction.norm();
  if (!(std::abs(norm - 1) <= kUnitTolerance)) {
    violations.Add(field,
                   absl::StrCat("want a unit vector, got ", Text(direction)));
    return;
  }
  if (std::abs(norm - 1) > kUnitExact) direction /= norm;
}

void CheckSize(absl::string_view field, size_t size, int want,
               Violations& violations) {
  if (size == 0 || size == static_cast<size_t>(want)) return;
  violations.Add(
      field, absl::StrFormat("want %d numbers or none, got %d", want, size));
}

// One number per degree of freedom, or none.
void CheckRates(absl::string_view field, const std::vector<double>& values,
                int want, Violations& violations) {
  CheckSize(field, values.size(), want, violations);
  for (size_t i = 0; i < values.size(); ++i) {
    CheckNotNegative(absl::StrCat(field, "[", i, "]"), values[i], violations);
  }
}

// Stored coordinates that lower and upper bound.
int BoundedCount(JointType type) {
  switch (type) {
    case JointType::kSpherical:
      return 0;
    case JointType::kFree:
      return 3;
    default:
      return PositionCount(type);
  }
}

void CheckBox(absl::string_view field, const Joint& joint,
              Violations& violations) {
  const JointLimits& limits = joint.limits;
  const int want = BoundedCount(joint.type);
  CheckSize(absl::StrCat(field, ".limits.lower"), limits.lower.size(), want,
            violations);
  if (limits.lower.size() != limits.upper.size()) {
    violations.Add(absl::StrCat(field, ".limits.upper"),
                   absl::StrFormat("want as many numbers as lower, %d, got %d",
                                   limits.lower.size(), limits.upper.size()));
    return;
  }
  for (size_t i = 0; i < limits.lower.size(); ++i) {
    const double lower = limits.lower[i];
    const double upper = limits.upper[i];
    // No limit on its side is what is beyond the numbers that are computed
    // with; NaN fails the comparison.
    if (lower <= upper && lower <= kLargestNumber && upper >= -kLargestNumber) {
      continue;
    }
    violations.Add(absl::StrCat(field, ".limits.lower[", i, "]"),
                   absl::StrFormat("joint %s: lower limit %g > upper limit %g",
                                   QuotedId(joint.id), lower, upper));
  }
}

void CheckAngle(absl::string_view field, const std::optional<double>& angle,
                double lower, double upper, Violations& violations) {
  if (!angle || (*angle >= lower && *angle <= upper)) return;
  violations.Add(field, absl::StrFormat("want %g to %g rad, got %g", lower,
                                        upper, *angle));
}

void CheckRotationLimits(absl::string_view field, const Joint& joint,
                         Violations& violations) {
  const JointLimits& limits = joint.limits;
  if (!limits.HasRotationLimits()) return;
  if (joint.type != JointType::kSpherical && joint.type != JointType::kFree) {
    violations.Add(absl::StrCat(field, ".limits"),
                   absl::StrCat("swing and twist limits do not fit a ",
                                JointTypeName(joint.type), " joint"));
    return;
  }
  CheckAngle(absl::StrCat(field, ".limits.swing_cone_rad"),
             limits.swing_cone_rad, 0, std::numbers::pi, violations);
  CheckAngle(absl::StrCat(field, ".limits.twist_lower_rad"),
             limits.twist_lower_rad, -kMaxTwist, kMaxTwist, violations);
  CheckAngle(absl::StrCat(field, ".limits.twist_upper_rad"),
             limits.twist_upper_rad, -kMaxTwist, kMaxTwist, violations);
  // A side that is not given ends at half a turn.
  const double lower = limits.twist_lower_rad.value_or(-std::numbers::pi);
  const double upper = limits.twist_upper_rad.value_or(std::numbers::pi);
  if (lower > upper) {
    violations.Add(absl::StrCat(field, ".limits.twist_lower_rad"),
                   absl::StrFormat("joint %s: lower limit %g > upper limit %g",
                                   QuotedId(joint.id), lower, upper));
  }
}

void CheckMimic(absl::string_view field, const Joint& joint,
                Violations& violations) {
  if (!joint.mimic) return;
  if (joint.type != JointType::kRevolute &&
      joint.type != JointType::kPrismatic) {
    violations.Add(absl::StrCat(field, ".mimic"),
                   absl::StrCat("a ", JointTypeName(joint.type),
                                " joint cannot follow another"));
  }
  CheckNumber(absl::StrCat(field, ".mimic.multiplier"), joint.mimic->multiplier,
              violations);
  CheckNumber(absl::StrCat(field, ".mimic.offset"), joint.mimic->offset,
              violations);
}

}  // namespace

std::string Text(const Eigen::Vector3d& v) {
  return absl::StrFormat("(%g, %g, %g)", v.x(), v.y(), v.z());
}

std::string QuotedId(absl::string_view id) {
  const bool cut = id.size() > kMaxIdBytes;
  return absl::StrCat("\"", absl::CHexEscape(id.substr(0, kMaxIdBytes)),
                      cut ? "...\"" : "\"");
}

void CheckId(absl::string_view field, absl::string_view id,
             Violations& violations) {
  if (id.empty() || id.size() > kMaxIdBytes) {
    violations.Add(field, absl::StrFormat("want 1 to %d bytes, got %d",
                                          kMaxIdBytes, id.size()));
    return;
  }
  for (unsigned char c : id) {
    if (!absl::ascii_iscntrl(c)) continue;
    violations.Add(field, absl::StrCat("control character in ", QuotedId(id)));
    return;
  }
}

void CheckAndNormalize(absl::string_view field, RigidTransform& transform,
                       Violations& violations) {
  CheckNumbers(absl::StrCat(field, ".translation"), transform.translation,
               violations);
  if (!NormalizeNearUnit(transform.rotation.coeffs().data())) {
    const Eigen::Quaterniond& q = transform.rotation;
    violations.Add(
        absl::StrCat(field, ".rotation"),
        absl::StrFormat("want a unit quaternion, got (%g, %g, %g, %g)", q.x(),
                        q.y(), q.z(), q.w()));
  }
}

void CheckAndNormalize(absl::string_view field, Joint& joint,
                       Violations& violations) {
  CheckId(absl::StrCat(field, ".joint_id"), joint.id, violations);
  CheckAndNormalize(absl::StrCat(field, ".parent_from_joint"),
                    joint.parent_from_joint, violations);
  if (NeedsAxis(joint.type) || joint.limits.HasRotationLimits()) {
    CheckUnit(absl::StrCat(field, ".axis"), joint.axis, violations);
  }
  CheckUnit(absl::StrCat(field, ".link_direction"), joint.link_direction,
            violations);
  CheckBox(field, joint, violations);
  CheckRotationLimits(field, joint, violations);
  CheckMimic(field, joint, violations);
  const int rates = VelocityCount(joint.type);
  CheckRates(absl::StrCat(field, ".limits.max_velocity"),
             joint.limits.max_velocity, rates, violations);
  CheckRates(absl::StrCat(field, ".limits.max_acceleration"),
             joint.limits.max_acceleration, rates, violations);
  CheckRates(absl::StrCat(field, ".stiffness"), joint.stiffness, rates,
             violations);
  CheckNotNegative(absl::StrCat(field, ".link_length_m"), joint.link_length_m,
                   violations);
  CheckNotNegative(absl::StrCat(field, ".link_mass_kg"), joint.link_mass_kg,
                   violations);
  CheckNumbers(absl::StrCat(field, ".link_center_of_mass"),
               joint.link_center_of_mass, violations);
}

}  // namespace gelenk
