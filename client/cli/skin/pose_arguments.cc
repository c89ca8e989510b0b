#include "client/cli/skin/pose_arguments.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_format.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/text/number_list.h"
#include "convert/pose.h"
#include "convert/skeleton.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/joint_map.h"

namespace gelenk::cli {
namespace {

// A column a frame.
struct Motion {
  Eigen::MatrixXd positions;
  double frame_time_s = 0;
};

absl::StatusOr<Motion> MotionOf(const PoseArguments& arguments,
                                const std::shared_ptr<const Skeleton>& target) {
  const std::string& path = arguments.motion_path;
  if (!arguments.retargets) {
    absl::StatusOr<MotionFile> file = ReadMotionFile(path, arguments.motion);
    if (!file.ok()) return file.status();
    const double frame_time_s = FrameTimeOf(file->clip);
    absl::StatusOr<Eigen::MatrixXd> frames =
        FramesFromClip(file->clip, frame_time_s);
    if (!frames.ok()) return InFile(path, frames.status());
    if (frames->rows() != target->position_count()) {
      return InFile(path, absl::InvalidArgumentError(absl::StrFormat(
                              "its poses have %d numbers, those of the skin's "
                              "skeleton %d: another skeleton wants --retarget",
                              frames->rows(), target->position_count())));
    }
    return Motion{*std::move(frames), frame_time_s};
  }
  const absl::StatusOr<BodyFile> source =
      ReadMovingBodyFile(path, arguments.motion);
  if (!source.ok()) return source.status();
  if (!source->has_motion()) {
    return InFile(path, absl::InvalidArgumentError("has no motion"));
  }
  const absl::StatusOr<JointMap> map = ProposeJointMap(*target);
  if (!map.ok()) return map.status();
  absl::StatusOr<std::shared_ptr<const BodyModel>> model =
      MakeBodyModel(target, *map);
  if (!model.ok()) return model.status();
  absl::StatusOr<Eigen::MatrixXd> positions = RetargetBody(
      *source, *std::move(model), LookAhead::kWholeClip, RetargetOptions());
  if (!positions.ok()) return InFile(path, positions.status());
  return Motion{*std::move(positions), source->frame_time_s};
}

absl::StatusOr<PoseList> PosesOfMotion(const PoseArguments& arguments,
                                       const v1::Skeleton& skeleton) {
  absl::StatusOr<std::shared_ptr<const Skeleton>> target =
      convert::FromProto(skeleton);
  if (!target.ok()) return target.status();
  const absl::StatusOr<Motion> motion = MotionOf(arguments, *target);
  if (!motion.ok()) return motion.status();
  const int count = static_cast<int>(motion->positions.cols());
  const int first = arguments.first_frame;
  const int frames = arguments.frame_count.value_or(count - first);
  if (first < 0 || first >= count || frames < 1 || frames > count - first) {
    return InFile(arguments.motion_path,
                  absl::OutOfRangeError(absl::StrFormat(
                      "has frames 0 to %d, got --first %d --frames %d",
                      count - 1, first, frames)));
  }
  PoseList list;
  list.frame_time = absl::Seconds(motion->frame_time_s);
  for (int i = first; i < first + frames; ++i) {
    convert::ToProto(motion->positions.col(i),
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
  CLI::Option* bvh = app.add_option("--bvh,--motion", arguments->motion_path,
                                    "Motion capture (.bvh), or a model with an "
                                    "animation, on the same skeleton")
                         ->excludes(pose)
                         ->option_text("FILE");
  AddAnimationOption(app, "--animation", &arguments->motion.animation);
  app.get_option("--animation")->needs(bvh);
  app.add_flag("--retarget", arguments->retargets,
               "It is of another body: bring its motion onto this one")
      ->needs(bvh);
  app.add_option("--bvh-unit", arguments->motion.unit_m,
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

absl::StatusOr<PoseList> PosesOf(const PoseArguments& arguments,
                                 const v1::Skeleton& skeleton) {
  if (!arguments.motion_path.empty()) {
    return PosesOfMotion(arguments, skeleton);
  }
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
