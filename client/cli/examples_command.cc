// gelenk examples: the worked examples of the methods, computed by the service,
// in the form in which a person checks them.
#include <cmath>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/command.h"
#include "client/cli/examples/leg_example.h"
#include "client/cli/file_bytes.h"
#include "client/cli/picture/leg_picture.h"
#include "client/cli/picture/tangent_picture.h"
#include "client/cli/service.h"
#include "client/cli/text/table.h"
#include "client/cli/uploaded_skeleton.h"
#include "gelenk/ik/newton_1d.h"

namespace gelenk::cli {
namespace {

using client::Connection;
using Numbers = std::vector<double>;

// Iterates of the numeric methods that are printed.
constexpr int kPrintedIterates = 6;
// The lengths of that example are hundreds: this is their rounding.
constexpr double kExactly = 1e-11;

struct ExamplesOptions {
  CLI::App* leg = nullptr;
  std::string folder;
  std::string leg_folder = ".";
};

v1::Skeleton ChainOf(const Numbers& lengths, double x, double y) {
  v1::Skeleton skeleton;
  v1::PlanarChain& chain = *skeleton.mutable_planar_chain();
  chain.mutable_link_lengths()->Assign(lengths.begin(), lengths.end());
  chain.mutable_base()->set_x(x);
  chain.mutable_base()->set_y(y);
  return skeleton;
}

v1::Pose PoseOf(const Numbers& numbers) {
  v1::Pose pose;
  pose.mutable_positions()->Assign(numbers.begin(), numbers.end());
  return pose;
}

std::string Degrees(double angle_rad) {
  return absl::StrCat(Fixed(angle_rad * 180 / M_PI, 6), " deg");
}

// The joints of a chain, and its tip.
absl::Status PrintForwardKinematics(const std::shared_ptr<Connection>& service,
                                    std::string* output) {
  absl::StrAppend(output,
                  "Forward kinematics: links 4, 6, 2 from (0, 0); "
                  "angles 60, 270, 60 degrees\n");
  // The joint of one more link stands at the tip.
  const auto skeleton =
      UploadedSkeleton::Create(service, ChainOf({4, 6, 2, 1}, 0, 0));
  if (!skeleton.ok()) return skeleton.status();
  Table table({{"point"},
               {"x", Align::kRight},
               {"y", Align::kRight},
               {"in closed form"}});
  v1::ComputeForwardKinematicsRequest request;
  request.set_skeleton((*skeleton)->name());
  *request.add_poses() = PoseOf({M_PI / 3, 1.5 * M_PI, M_PI / 3, 0});
  const auto response = service->Call(
      &v1::KinematicsService::Stub::ComputeForwardKinematics, request);
  if (!response.ok()) return response.status();
  const auto& points = response->joint_frames(0).world_translations();
  const char* const closed[] = {"(0, 0)", "(2, 2 sqrt 3)",
                                "(2 + 3 sqrt 3, 2 sqrt 3 - 3)",
                                "(2 + 4 sqrt 3, 2 sqrt 3 - 2)"};
  for (int i = 0; i < 4; ++i) {
    table.AddRow({absl::StrCat("P", i + 1), Fixed(points[3 * i], 5),
                  Fixed(points[3 * i + 1], 5), closed[i]});
  }
  absl::StrAppend(output, table.ToString(), "\n");
  return absl::OkStatus();
}

absl::Status PrintTwoLink(const std::shared_ptr<Connection>& service,
                          std::string* output) {
  absl::StrAppend(output,
                  "Two links of 10 and 10 from (0, 0) to (10, 0), closed "
                  "form\n");
  v1::SolveTwoLinkRequest request;
  v1::PlanarTwoLink& planar = *request.mutable_planar();
  planar.set_upper_length_m(10);
  planar.set_lower_length_m(10);
  planar.mutable_target()->set_x(10);
  const auto response =
      service->Call(&v1::KinematicsService::Stub::SolveTwoLink, request);
  if (!response.ok()) return response.status();
  Table table(
      {{"solution"}, {"phi 1", Align::kRight}, {"phi 2", Align::kRight}});
  for (int i = 0; i < response->solutions_size(); ++i) {
    const v1::TwoLinkSolution& solution = response->solutions(i);
    table.AddRow({absl::StrCat(i + 1), Degrees(solution.angles_rad(0)),
                  Degrees(solution.angles_rad(1))});
  }
  absl::StrAppend(output, table.ToString(),
                  absl::StrFormat("reach %g to %g\n\n", response->min_reach_m(),
                                  response->max_reach_m()));
  return absl::OkStatus();
}

// The chain of the numeric examples.
class NumericExample {
 public:
  static absl::StatusOr<NumericExample> Create(
      const std::shared_ptr<Connection>& service) {
    auto skeleton =
        UploadedSkeleton::Create(service, ChainOf({150, 200, 100}, 50, 400));
    if (!skeleton.ok()) return skeleton.status();
    return NumericExample(service, *std::move(skeleton));
  }

  // Rows x and y of the Jacobian.
  absl::StatusOr<v1::Matrix> Jacobian() const {
    v1::ComputeJacobianRequest request;
    request.set_skeleton(skeleton_->name());
    request.set_end_effector_id("tip");
    *request.add_poses() = PoseOf(kStart);
    const auto response =
        service_->Call(&v1::KinematicsService::Stub::ComputeJacobian, request);
    if (!response.ok()) return response.status();
    return response->jacobians(0);
  }

  absl::StatusOr<v1::SolveInverseKinematicsResponse> Solve(
      v1::SolverMethod method, int iterations) const {
    v1::SolveInverseKinematicsRequest request;
    request.set_skeleton(skeleton_->name());
    v1::Goal& goal = *request.add_goals();
    goal.set_goal_id("tip");
    v1::PositionGoal& position = *goal.mutable_position();
    position.set_end_effector_id("tip");
    position.mutable_world_position()->set_x(350);
    position.mutable_world_position()->set_y(700);
    position.mutable_axes()->set_x(true);
    position.mutable_axes()->set_y(true);
    *request.mutable_start_pose() = PoseOf(kStart);
    request.mutable_solver_options()->set_method(method);
    request.mutable_solver_options()->set_max_iterations(iterations);
    request.mutable_solver_options()->set_max_restarts(0);
    request.mutable_solver_options()->set_position_tolerance_m(kExactly);
    return service_->Call(&v1::KinematicsService::Stub::SolveInverseKinematics,
                          request);
  }

 private:
  NumericExample(std::shared_ptr<Connection> service,
                 std::unique_ptr<UploadedSkeleton> skeleton)
      : service_(std::move(service)), skeleton_(std::move(skeleton)) {}

  inline static const Numbers kStart = {0.6, 1.0, -0.7};

  std::shared_ptr<Connection> service_;
  std::unique_ptr<UploadedSkeleton> skeleton_;
};

void PrintJacobian(const v1::Matrix& jacobian, std::string* output) {
  const auto j = [&](int row, int column) {
    return jacobian.values(row * jacobian.column_count() + column);
  };
  absl::StrAppend(output, "J at (0.6, 1, -0.7)\n");
  Table table({{"", Align::kRight}, {"", Align::kRight}, {"", Align::kRight}});
  for (int r = 0; r < 2; ++r) {
    table.AddRow({Fixed(j(r, 0), 9), Fixed(j(r, 1), 9), Fixed(j(r, 2), 9)});
  }
  absl::StrAppend(output, table.ToString(), "J+ = J^T (J J^T)^-1\n");
  // Of two rows, by hand.
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (int c = 0; c < 3; ++c) {
    xx += j(0, c) * j(0, c);
    xy += j(0, c) * j(1, c);
    yy += j(1, c) * j(1, c);
  }
  const double det = xx * yy - xy * xy;
  Table inverse({{"", Align::kRight}, {"", Align::kRight}});
  for (int c = 0; c < 3; ++c) {
    inverse.AddRow({Fixed((j(0, c) * yy - j(1, c) * xy) / det, 12),
                    Fixed((j(1, c) * xx - j(0, c) * xy) / det, 12)});
  }
  absl::StrAppend(output, inverse.ToString());
}

std::vector<std::string> ResultRow(
    absl::string_view name, const v1::SolveInverseKinematicsResponse& result) {
  const auto& q = result.pose().positions();
  return {std::string(name),
          Fixed(q[0], 9),
          Fixed(q[1], 9),
          Fixed(q[2], 9),
          Significant(result.report().position_errors_m(0), 4),
          Fixed(result.report().change(), 9)};
}

Table ResultTable(absl::string_view first) {
  return Table({{std::string(first)},
                {"phi 1", Align::kRight},
                {"phi 2", Align::kRight},
                {"phi 3", Align::kRight},
                {"distance", Align::kRight},
                {"change", Align::kRight}});
}

absl::Status PrintNumeric(const std::shared_ptr<Connection>& service,
                          std::string* output) {
  absl::StrAppend(output,
                  "Newton: links 150, 200, 100 from (50, 400), angles (0.6, 1, "
                  "-0.7), to (350, 700)\n");
  const auto example = NumericExample::Create(service);
  if (!example.ok()) return example.status();
  const auto jacobian = example->Jacobian();
  if (!jacobian.ok()) return jacobian.status();
  PrintJacobian(*jacobian, output);

  absl::StrAppend(output, "q <- q - J+ g\n");
  Table iterates = ResultTable("iteration");
  for (int i = 0; i < kPrintedIterates; ++i) {
    const auto result = example->Solve(v1::SOLVER_METHOD_PSEUDO_INVERSE, i);
    if (!result.ok()) return result.status();
    iterates.AddRow(ResultRow(absl::StrCat(i), *result));
  }
  absl::StrAppend(
      output, iterates.ToString(),
      "where the methods end, and by how much the angles changed\n");
  Table ends = ResultTable("method");
  const std::pair<const char*, v1::SolverMethod> methods[] = {
      {"pseudo-inverse", v1::SOLVER_METHOD_PSEUDO_INVERSE},
      {"minimal change", v1::SOLVER_METHOD_MINIMAL_CHANGE}};
  for (const auto& [name, method] : methods) {
    const auto result = example->Solve(method, 200);
    if (!result.ok()) return result.status();
    ends.AddRow(ResultRow(name, *result));
  }
  absl::StrAppend(output, ends.ToString(), "\n");
  return absl::OkStatus();
}

// A function that is no service's business: the user's own.
absl::Status PrintOneDimension(const ExamplesOptions& options,
                               std::string* output) {
  absl::StrAppend(output,
                  "Newton in one dimension: x^2 - 2 from 0.4, by finite "
                  "differences\n");
  const ScalarFunction function = [](double x) { return x * x - 2; };
  Newton1dOptions newton;
  newton.start = 0.4;
  const auto result = FindZero(function, nullptr, newton);
  if (!result.ok()) return result.status();
  Table table({{"iteration"},
               {"x", Align::kRight},
               {"f", Align::kRight},
               {"slope", Align::kRight}});
  int iteration = 0;
  for (const Tangent& tangent : result->tangents) {
    table.AddRow({absl::StrCat(iteration++), Fixed(tangent.x, 12),
                  Significant(tangent.f, 6), Fixed(tangent.slope, 6)});
  }
  absl::StrAppend(output, table.ToString(),
                  absl::StrFormat("zero at %.15f\n", result->x));
  if (options.folder.empty()) return absl::OkStatus();
  const std::string path = absl::StrCat(options.folder, "/newton_1d.svg");
  if (absl::Status status =
          WriteFile(path, TangentPicture(function, *result, 0, 2.8));
      !status.ok()) {
    return status;
  }
  absl::StrAppend(output, "picture: ", path, "\n");
  return absl::OkStatus();
}

// Needs no service: clips are the user's own.
absl::Status RunLeg(const ExamplesOptions& options, std::string* output) {
  const absl::StatusOr<LegExample> example = MakeLegExample();
  if (!example.ok()) return example.status();
  absl::StrAppend(output,
                  "A leg animated by keys from the top down: hip, thigh, shin, "
                  "foot\n");
  Table table({{""}, {"keys", Align::kRight}, {"contacts", Align::kRight}});
  const auto add = [&](absl::string_view name, int decimals, auto number) {
    table.AddRow({std::string(name),
                  Fixed(number(example->keyed.quality), decimals),
                  Fixed(number(example->planted.quality), decimals)});
  };
  add("planted points slide, cm/s", 2,
      [](const MotionQuality& q) { return q.skate.label_cm_s; });
  add("the foot sinks, at most, mm", 2,
      [](const MotionQuality& q) { return 1000 * q.penetration.max_m; });
  absl::StrAppend(output, table.ToString());
  const std::pair<const char*, std::string> pictures[] = {
      {"leg_naive.svg", LegPictureSvg(*example, example->keyed,
                                      "Keys alone: the foot slides and sinks")},
      {"leg_contacts.svg", LegPictureSvg(*example, example->planted,
                                         "The same keys, contacts kept")}};
  for (const auto& [name, picture] : pictures) {
    const std::string path = absl::StrCat(options.leg_folder, "/", name);
    if (absl::Status status = WriteFile(path, picture); !status.ok()) {
      return status;
    }
    absl::StrAppend(output, "picture: ", path, "\n");
  }
  return absl::OkStatus();
}

absl::Status RunExamples(const ExamplesOptions& options,
                         const GlobalOptions& globals, std::string* output) {
  const auto service = Service::Open(globals.server);
  if (!service.ok()) return service.status();
  const auto& connection = (*service)->connection();
  for (const auto print :
       {&PrintForwardKinematics, &PrintTwoLink, &PrintNumeric}) {
    if (absl::Status status = print(connection, output); !status.ok()) {
      return status;
    }
  }
  return PrintOneDimension(options, output);
}

}  // namespace

Command AddExamplesCommand(CLI::App& app) {
  auto options = std::make_shared<ExamplesOptions>();
  CLI::App* examples = app.add_subcommand(
      "examples", "Worked examples of the methods, to be checked by hand");
  examples
      ->add_option("--out", options->folder,
                   "Also writes the picture newton_1d.svg to this folder")
      ->option_text("DIR");
  options->leg = examples->add_subcommand(
      "leg",
      "Hip, knee and foot by keys alone, and with contacts: two pictures, and "
      "how far the foot slides and sinks");
  options->leg
      ->add_option("--out", options->leg_folder,
                   "Where leg_naive.svg and leg_contacts.svg go; default: here")
      ->option_text("DIR");
  examples->footer(
      "Examples:\n"
      "  gelenk examples --out .\n"
      "  gelenk examples leg --out .");
  return {
      examples, [options](const GlobalOptions& globals, std::string* output) {
        return options->leg->parsed() ? RunLeg(*options, output)
                                      : RunExamples(*options, globals, output);
      }};
}

}  // namespace gelenk::cli
