#include "client/cli/play/limit_choice.h"

#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/file_bytes.h"
#include "client/cli/skeleton_file.h"
#include "gelenk/motion/body_height.h"
#include "gelenk/motion/clip_limits.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::cli {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Lengths may go this much further than in the clip, of the body's height.
constexpr double kLengthMarginOfHeight = 0.01;

std::string JointNames(const Skeleton& skeleton,
                       const std::vector<int>& joints) {
  return absl::StrJoin(joints, ", ", [&](std::string* out, int joint) {
    absl::StrAppend(out, skeleton.joint(joint).id);
  });
}

absl::StatusOr<LimitedSkeleton> FromClip(const BvhClip& clip) {
  const Skeleton& skeleton = *clip.import.skeleton;
  ClipLimitMargins margins;
  if (const auto height = BodyHeight(skeleton, FindBodyParts(skeleton))) {
    margins.length_m = kLengthMarginOfHeight * *height;
  }
  absl::StatusOr<ClipLimits> limits =
      LimitToClip(skeleton, clip.poses, margins);
  if (!limits.ok()) return limits.status();
  LimitedSkeleton limited;
  limited.skeleton = std::move(limits->skeleton);
  limited.description =
      absl::StrFormat("range of the clip ± %.0f° (lengths ± %.1f cm)",
                      margins.angle_rad / kDegree, margins.length_m * 100);
  if (!limits->twisting_whole_turn.empty()) {
    limited.notes.push_back(
        absl::StrCat("no limit of twist, turning all around: ",
                     JointNames(skeleton, limits->twisting_whole_turn)));
  }
  if (!limits->swinging_half_turn.empty()) {
    limited.notes.push_back(absl::StrCat(
        "no limit of twist, undefined near a swing of half a turn: ",
        JointNames(skeleton, limits->swinging_half_turn)));
  }
  return limited;
}

absl::StatusOr<LimitedSkeleton> FromFile(const BvhClip& clip,
                                         const std::string& path) {
  const absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(path, {});
  if (!file.ok()) return file.status();
  const Skeleton& skeleton = *clip.import.skeleton;
  SkeletonBuilder builder;
  int found = 0;
  for (Joint joint : skeleton.joints()) {
    const int source = file->skeleton->FindJoint(joint.id);
    if (source >= 0) {
      joint.limits = file->skeleton->joint(source).limits;
      if (!NeedsAxis(joint.type)) {
        joint.axis = file->skeleton->joint(source).axis;
      }
      ++found;
    }
    builder.AddJoint(std::move(joint));
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    builder.AddEndEffector(effector);
  }
  auto limited = builder.SetUp(skeleton.up())
                     .SetRestPositions(skeleton.rest_positions())
                     .Build();
  if (!limited.ok()) return InFile(path, limited.status());
  return LimitedSkeleton{
      *std::move(limited),
      absl::StrFormat("of %s for %d of %d joints", BaseName(path), found,
                      skeleton.joint_count()),
      {}};
}

}  // namespace

absl::StatusOr<LimitedSkeleton> ChooseLimits(const BvhClip& clip,
                                             const std::string& choice) {
  if (choice == kNoLimits) {
    return LimitedSkeleton{clip.import.skeleton, "none", {}};
  }
  return choice == kClipLimits ? FromClip(clip) : FromFile(clip, choice);
}

}  // namespace gelenk::cli
