// gelenk fk: joint angles in, joint frames out.
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/joint_frames_text.h"
#include "client/cli/picture/pose_picture.h"
#include "client/cli/service.h"
#include "client/cli/skeleton_file.h"
#include "client/cli/text/number_list.h"
#include "client/cli/uploaded_skeleton.h"
#include "convert/pose.h"

namespace gelenk::cli {
namespace {

struct FkOptions {
  SkeletonFileOptions file;
  Format format = Format::kTable;
  std::string pose;
  std::string pose_path;
  std::optional<int> frame;
  std::string picture_path;
};

v1::Pose PoseOf(const std::vector<double>& numbers) {
  v1::Pose pose;
  pose.mutable_positions()->Assign(numbers.begin(), numbers.end());
  return pose;
}

absl::StatusOr<v1::Pose> PoseOfFrame(const SkeletonFile& file, int frame) {
  if (!file.clip) {
    return InFile(file.path, absl::InvalidArgumentError(
                                 "--frame: a skeleton file has no frames"));
  }
  if (frame < 0 || frame >= file.clip->frame_count()) {
    return InFile(file.path, absl::OutOfRangeError(absl::StrFormat(
                                 "--frame: want 0 to %d, got %d",
                                 file.clip->frame_count() - 1, frame)));
  }
  v1::Pose pose;
  convert::ToProto(file.clip->poses.col(frame), &pose);
  return pose;
}

absl::StatusOr<v1::Pose> PoseFromFile(const std::string& path) {
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  const absl::StatusOr<std::vector<double>> numbers = ParseNumbers(*bytes);
  if (!numbers.ok()) return InFile(path, numbers.status());
  return PoseOf(*numbers);
}

// What the options ask for, else the rest pose.
absl::StatusOr<v1::Pose> ChosenPose(const FkOptions& options,
                                    const SkeletonFile& file) {
  if (options.frame) return PoseOfFrame(file, *options.frame);
  if (!options.pose_path.empty()) return PoseFromFile(options.pose_path);
  if (!options.pose.empty()) {
    const absl::StatusOr<std::vector<double>> numbers =
        ParseNumbers(options.pose);
    if (!numbers.ok()) return numbers.status();
    return PoseOf(*numbers);
  }
  return file.message.rest_pose();
}

absl::Status RunFk(const FkOptions& options, const GlobalOptions& globals,
                   std::string* output) {
  const absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(
      options.file.path, options.file.unit_m, options.file.skin);
  if (!file.ok()) return file.status();
  const absl::StatusOr<v1::Pose> pose = ChosenPose(options, *file);
  if (!pose.ok()) return pose.status();
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const auto skeleton =
      UploadedSkeleton::Create((*service)->connection(), file->message);
  if (!skeleton.ok()) return skeleton.status();

  v1::ComputeForwardKinematicsRequest request;
  request.set_skeleton((*skeleton)->name());
  *request.add_poses() = *pose;
  const auto response = (*service)->connection()->Call(
      &v1::KinematicsService::Stub::ComputeForwardKinematics, request);
  if (!response.ok()) return response.status();
  const v1::JointFrames& frames = response->joint_frames(0);
  *output +=
      options.format == Format::kJson
          ? JsonText({{"joints", JointFramesJson(*file->skeleton, frames)}})
          : JointFramesText(*file->skeleton, frames);
  if (options.picture_path.empty()) return absl::OkStatus();
  // The service took the pose, so it is of this skeleton.
  const Eigen::VectorXd positions = Eigen::Map<const Eigen::VectorXd>(
      pose->positions().data(), pose->positions_size());
  return WriteFile(
      options.picture_path,
      PosePictureSvg(*file->skeleton, positions, {}, BaseName(file->path)));
}

}  // namespace

Command AddFkCommand(CLI::App& app) {
  auto options = std::make_shared<FkOptions>();
  CLI::App* fk = app.add_subcommand(
      "fk", "Forward kinematics: where the joints are in a pose");
  AddSkeletonFileOptions(*fk, &options->file);
  CLI::Option_group* pose =
      fk->add_option_group("Pose", "Which pose; without any, the rest pose");
  pose->add_option("--pose", options->pose,
                   "Numbers of the pose: rad, m, quaternions x y z w")
      ->check(
          Parses([](const std::string& text) { return ParseNumbers(text); }))
      ->option_text("Q0,Q1,...");
  pose->add_option("--pose-file", options->pose_path,
                   "A file with those numbers")
      ->option_text("FILE");
  pose->add_option("--frame", options->frame, "A frame of the BVH file, from 0")
      ->option_text("N");
  pose->require_option(0, 1);
  fk->add_option("--picture", options->picture_path, "Draw the pose")
      ->check(EndsWith({".svg"}))
      ->option_text("FILE.svg");
  AddFormatOption(*fk, &options->format);
  fk->footer(
      "Examples:\n"
      "  gelenk fk walk.bvh --frame 100\n"
      "  gelenk fk robot.urdf\n"
      "  gelenk fk arm.json --pose 0.1,-0.5,1.2 --format json");
  return {fk, [options](const GlobalOptions& globals, std::string* output) {
            return RunFk(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
