#include "gelenk/motion/joint_track.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/math/rotation.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

void CheckTimes(absl::string_view field, const std::vector<double>& times_s,
                Violations& violations) {
  if (times_s.empty()) {
    violations.Add(absl::StrCat(field, ".times_s"), "want at least one key");
  }
  for (size_t i = 0; i < times_s.size(); ++i) {
    if (!(std::isfinite(times_s[i]) && times_s[i] >= 0)) {
      violations.Add(
          absl::StrCat(field, ".times_s[", i, "]"),
          absl::StrCat("want a finite number >= 0, got ", times_s[i]));
    } else if (i > 0 && times_s[i] <= times_s[i - 1]) {
      violations.Add(
          absl::StrCat(field, ".times_s[", i, "]"),
          absl::StrFormat("want more than the key before, %.17g, got %.17g",
                          times_s[i - 1], times_s[i]));
    }
  }
}

bool CheckMatrix(const std::string& field, const Eigen::MatrixXd& matrix,
                 Eigen::Index rows, Eigen::Index cols, Violations& violations) {
  if (matrix.rows() != rows || matrix.cols() != cols) {
    violations.Add(
        field, absl::StrFormat("want %d keys of %d numbers, got %d of %d", cols,
                               rows, matrix.cols(), matrix.rows()));
    return false;
  }
  if (matrix.allFinite()) return true;
  for (Eigen::Index key = 0; key < cols; ++key) {
    for (Eigen::Index row = 0; row < rows; ++row) {
      if (std::isfinite(matrix(row, key))) continue;
      violations.Add(
          absl::StrCat(field, "[", key, "][", row, "]"),
          absl::StrCat("want a finite number, got ", matrix(row, key)));
    }
  }
  return false;
}

void NormalizeRotations(const std::string& field, JointTrack& track,
                        Violations& violations) {
  const bool has_tangents = track.interpolation == Interpolation::kCubicSpline;
  for (Eigen::Index key = 0; key < track.values.cols(); ++key) {
    auto q = track.values.col(key);
    if (!NormalizeNearUnit(q.data())) {
      violations.Add(
          absl::StrCat(field, "[", key, "]"),
          absl::StrFormat("want a unit quaternion, got (%g, %g, %g, %g)", q[0],
                          q[1], q[2], q[3]));
    }
    // Tangents are of the quaternion as it is given, so that its sign counts.
    if (key > 0 && !has_tangents && track.values.col(key - 1).dot(q) < 0) {
      q = -q;
    }
  }
}

}  // namespace

absl::string_view InterpolationName(Interpolation interpolation) {
  switch (interpolation) {
    case Interpolation::kStep:
      return "step";
    case Interpolation::kLinear:
      return "linear";
    case Interpolation::kCubicSpline:
      return "cubic spline";
    case Interpolation::kCatmullRom:
      return "Catmull-Rom";
  }
  return "unknown";
}

void CheckAndNormalize(absl::string_view field, const Skeleton& skeleton,
                       JointTrack& track, Violations& violations) {
  if (track.joint < 0 || track.joint >= skeleton.joint_count()) {
    violations.Add(absl::StrCat(field, ".joint"),
                   absl::StrFormat("want a joint, 0 to %d, got %d",
                                   skeleton.joint_count() - 1, track.joint));
    return;
  }
  const std::optional<PosePart> part =
      FindPosePart(skeleton, track.joint, track.kind);
  if (!part) {
    const Joint& joint = skeleton.joint(track.joint);
    violations.Add(
        absl::StrCat(field, ".kind"),
        absl::StrCat("joint ", QuotedId(joint.id), ", ",
                     joint.mimic ? "a mimic" : JointTypeName(joint.type),
                     ", has no ", PosePartKindName(track.kind)));
    return;
  }
  CheckTimes(field, track.times_s, violations);
  const Eigen::Index rows = part->position_count;
  const Eigen::Index keys = track.key_count();
  const std::string values = absl::StrCat(field, ".values");
  const bool is_sound =
      CheckMatrix(values, track.values, rows, keys, violations);
  const Eigen::Index tangents =
      track.interpolation == Interpolation::kCubicSpline ? keys : 0;
  const Eigen::Index tangent_rows = tangents > 0 ? rows : 0;
  CheckMatrix(absl::StrCat(field, ".in_tangents"), track.in_tangents,
              tangent_rows, tangents, violations);
  CheckMatrix(absl::StrCat(field, ".out_tangents"), track.out_tangents,
              tangent_rows, tangents, violations);
  if (is_sound && track.kind == PosePartKind::kRotation) {
    NormalizeRotations(values, track, violations);
  }
}

}  // namespace gelenk
