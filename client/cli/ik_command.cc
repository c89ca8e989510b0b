// gelenk ik: goals in, one pose out.
#include <google/protobuf/util/json_util.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/command.h"
#include "client/cli/file_bytes.h"
#include "client/cli/goal_argument.h"
#include "client/cli/ik_result_text.h"
#include "client/cli/picture/pose_picture.h"
#include "client/cli/service.h"
#include "client/cli/skeleton_file.h"
#include "client/cli/text/number_list.h"
#include "client/cli/tolerance.h"
#include "client/cli/uploaded_skeleton.h"
#include "convert/geometry.h"
#include "convert/goal.h"

namespace gelenk::cli {
namespace {

constexpr char kRest[] = "rest";

struct IkOptions {
  SkeletonFileOptions file;
  Format format = Format::kTable;
  std::vector<std::string> position_goals;
  std::vector<std::string> rotation_goals;
  std::vector<std::string> pose_goals;
  std::string start = kRest;
  std::string tolerance;
  bool diagnose = false;
  std::string request_path;
  std::string picture_path;
};

using GoalParser = absl::StatusOr<GoalKind> (*)(absl::string_view);

absl::Status AddGoals(const std::vector<std::string>& arguments,
                      GoalParser parse, std::vector<GoalKind>& kinds) {
  for (const std::string& argument : arguments) {
    absl::StatusOr<GoalKind> kind = parse(argument);
    if (!kind.ok()) return kind.status();
    kinds.push_back(*std::move(kind));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Goal>> GoalsOf(const IkOptions& options) {
  std::vector<GoalKind> kinds;
  absl::Status status;
  status.Update(AddGoals(options.position_goals, ParsePositionGoal, kinds));
  status.Update(AddGoals(options.rotation_goals, ParseRotationGoal, kinds));
  status.Update(AddGoals(options.pose_goals, ParsePoseGoal, kinds));
  if (!status.ok()) return status;
  return NameGoals(std::move(kinds));
}

absl::StatusOr<v1::SolveInverseKinematicsRequest> RequestFromFile(
    const std::string& path) {
  const absl::StatusOr<std::string> json = ReadFile(path);
  if (!json.ok()) return json.status();
  v1::SolveInverseKinematicsRequest request;
  const auto status =
      google::protobuf::util::JsonStringToMessage(*json, &request);
  if (!status.ok()) {
    return InFile(path,
                  absl::InvalidArgumentError(std::string(status.message())));
  }
  return request;
}

// The points that goals name, for the picture.
std::vector<Eigen::Vector3d> TargetPoints(
    const v1::SolveInverseKinematicsRequest& request) {
  std::vector<Eigen::Vector3d> points;
  for (const v1::Goal& goal : request.goals()) {
    if (goal.has_position()) {
      points.push_back(convert::FromProto(goal.position().world_position()));
    } else if (goal.has_pose()) {
      points.push_back(
          convert::FromProto(goal.pose().world_pose().translation()));
    }
  }
  return points;
}

// All but the skeleton's name.
absl::StatusOr<v1::SolveInverseKinematicsRequest> RequestFor(
    const IkOptions& options) {
  const absl::StatusOr<std::vector<Goal>> goals = GoalsOf(options);
  if (!goals.ok()) return goals.status();
  v1::SolveInverseKinematicsRequest request;
  if (!options.request_path.empty()) {
    auto read = RequestFromFile(options.request_path);
    if (!read.ok()) return read;
    request = *std::move(read);
  }
  google::protobuf::RepeatedPtrField<v1::Goal> more;
  convert::ToProto(*goals, &more);
  request.mutable_goals()->MergeFrom(more);
  // The rest pose is what is meant by no start: the solve is then a cold one.
  if (options.start != kRest) {
    const auto numbers = ParseNumbers(options.start);
    if (!numbers.ok()) return numbers.status();
    request.mutable_start_pose()->mutable_positions()->Assign(numbers->begin(),
                                                              numbers->end());
  }
  v1::SolverOptions& solver = *request.mutable_solver_options();
  if (options.diagnose) solver.set_diagnose(true);
  if (!options.tolerance.empty()) {
    const auto tolerance = ParseTolerance(options.tolerance, Tolerance());
    if (!tolerance.ok()) return tolerance.status();
    SetTolerance(*tolerance, &solver);
  }
  return request;
}

absl::Status RunIk(const IkOptions& options, const GlobalOptions& globals,
                   std::string* output) {
  const absl::StatusOr<SkeletonFile> file = ReadSkeletonFile(
      options.file.path, options.file.unit_m, options.file.skin);
  if (!file.ok()) return file.status();
  auto request = RequestFor(options);
  if (!request.ok()) return request.status();
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const auto skeleton =
      UploadedSkeleton::Create((*service)->connection(), file->message);
  if (!skeleton.ok()) return skeleton.status();

  request->set_skeleton((*skeleton)->name());
  const auto response = (*service)->connection()->Call(
      &v1::KinematicsService::Stub::SolveInverseKinematics, *request);
  if (!response.ok()) return response.status();
  *output += options.format == Format::kJson
                 ? JsonText(IkResultJson(*file->skeleton, *request, *response))
                 : IkResultText(*file->skeleton, *request, *response);
  if (options.picture_path.empty()) return absl::OkStatus();
  const auto& q = response->pose().positions();
  const Eigen::VectorXd positions =
      Eigen::Map<const Eigen::VectorXd>(q.data(), q.size());
  return WriteFile(
      options.picture_path,
      PosePictureSvg(*file->skeleton, positions, TargetPoints(*request),
                     BaseName(file->path)));
}

void AddGoalOption(CLI::App& ik, const std::string& name,
                   const std::string& form, const std::string& description,
                   GoalParser parse, std::vector<std::string>* goals) {
  ik.add_option(name, *goals, description)
      ->check(Parses(parse))
      ->allow_extra_args(false)
      ->option_text(form);
}

}  // namespace

Command AddIkCommand(CLI::App& app) {
  auto options = std::make_shared<IkOptions>();
  CLI::App* ik =
      app.add_subcommand("ik", "Inverse kinematics: a pose that reaches goals");
  AddSkeletonFileOptions(*ik, &options->file);
  AddGoalOption(*ik, "--goal", "ID=x,y,z",
                "Bring an end effector or joint to a point, m; repeatable",
                ParsePositionGoal, &options->position_goals);
  AddGoalOption(*ik, "--rotation-goal", "ID=qx,qy,qz,qw",
                "Turn it to an orientation; repeatable", ParseRotationGoal,
                &options->rotation_goals);
  AddGoalOption(*ik, "--pose-goal", "ID=x,y,z,qx,qy,qz,qw",
                "Both at once; repeatable", ParsePoseGoal,
                &options->pose_goals);
  ik->add_option("--start", options->start,
                 "Pose to start from; default: the rest pose, with restarts "
                 "from others where that leads nowhere")
      ->check(Parses(
          [](const std::string& text) -> absl::StatusOr<std::vector<double>> {
            if (text == kRest) return std::vector<double>();
            return ParseNumbers(text);
          }))
      ->option_text("Q0,Q1,...|rest");
  ik->add_option("--tolerance", options->tolerance,
                 "Errors that count as reached; default 1e-4 m, 1e-3 rad")
      ->check(Parses([](const std::string& text) {
        return ParseTolerance(text, Tolerance());
      }))
      ->option_text("M[,RAD]");
  ik->add_flag("--diagnose", options->diagnose,
               "Also print rank and manipulability");
  ik->add_option("--request", options->request_path,
                 "Goals of any kind, priorities, options: proto3 JSON of "
                 "gelenk.v1.SolveInverseKinematicsRequest, without skeleton; "
                 "the goals above come after its own")
      ->option_text("FILE.json");
  ik->add_option("--picture", options->picture_path,
                 "Draw the pose and its targets")
      ->check(EndsWith({".svg"}))
      ->option_text("FILE.svg");
  AddFormatOption(*ik, &options->format);
  ik->parse_complete_callback([options] {
    if (options->position_goals.empty() && options->rotation_goals.empty() &&
        options->pose_goals.empty() && options->request_path.empty()) {
      throw CLI::RequiredError(
          "a --goal, --rotation-goal, --pose-goal or --request");
    }
  });
  ik->footer(
      "Examples:\n"
      "  gelenk ik walk.bvh --goal LeftHand=0.4,1.2,0.3 --goal "
      "RightFoot=-0.1,0,0\n"
      "  gelenk ik robot.urdf --goal gripper=0.4,0.1,0.6\n"
      "  gelenk ik arm.json --pose-goal tool=0.5,0.2,0.1,0,0,0,1 --diagnose");
  return {ik, [options](const GlobalOptions& globals, std::string* output) {
            return RunIk(*options, globals, output);
          }};
}

}  // namespace gelenk::cli
