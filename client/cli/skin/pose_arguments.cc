#include "client/cli/skin/pose_arguments.h"

#include <algorithm>

#include "absl/strings/str_format.h"
#include "client/cli/bvh_clip.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/text/number_list.h"
#include "convert/pose.h"

namespace gelenk::cli {
namespace {

absl::StatusOr<PoseList> PosesOfClip(const PoseArguments& arguments) {
  const absl::StatusOr<BvhClip> clip =
      ReadBvhClip(arguments.bvh_path, arguments.unit_m);
  if (!clip.ok()) return clip.status();
  const int count = clip->frame_count();
  const int first = arguments.first_frame;
  const int frames = arguments.frame_count.value_or(count - first);
  if (first < 0 || first >= count || frames < 1 || frames > count - first) {
    return InFile(arguments.bvh_path,
                  absl::OutOfRangeError(absl::StrFormat(
                      "has frames 0 to %d, got --first %d --frames %d",
                      count - 1, first, frames)));
  }
  PoseList list;
  list.frame_time = clip->frame_time();
  for (int i = first; i < first + frames; ++i) {
    convert::ToProto(clip->poses.col(i),
                     list.poses.emplace_back().mutable_pose());
  }
  return list;
}

}  // namespace

void AddPoseOptions(CLI::App& app, PoseArguments* arguments) {
  CLI::Option* pose =
      app.add_option("--pose", arguments->pose,
                     "Numbers of one pose: rad, m, quaternions x y z w")
          ->check(Parses(
              [](const std::string& text) { return ParseNumbers(text); }))
          ->option_text("Q0,Q1,...");
  CLI::Option* bvh = app.add_option("--bvh", arguments->bvh_path,
                                    "Poses of a file on the same skeleton")
                         ->excludes(pose)
                         ->option_text("FILE");
  app.add_option("--bvh-unit", arguments->unit_m,
                 "Metres per unit of that file; default: guessed")
      ->needs(bvh)
      ->check(Positive())
      ->option_text("M");
  app.add_option("--first", arguments->first_frame, "First frame of it, from 0")
      ->needs(bvh)
      ->option_text("N");
  app.add_option("--frames", arguments->frame_count,
                 "So many frames; default: to the end")
      ->needs(bvh)
      ->option_text("N");
}

absl::StatusOr<PoseList> PosesOf(const PoseArguments& arguments) {
  if (!arguments.bvh_path.empty()) return PosesOfClip(arguments);
  PoseList list;
  if (arguments.pose.empty()) return list;
  const absl::StatusOr<std::vector<double>> numbers =
      ParseNumbers(arguments.pose);
  if (!numbers.ok()) return numbers.status();
  list.poses.emplace_back().mutable_pose()->mutable_positions()->Assign(
      numbers->begin(), numbers->end());
  return list;
}

}  // namespace gelenk::cli
