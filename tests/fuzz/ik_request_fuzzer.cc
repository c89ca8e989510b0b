// Any text says a skeleton and a request to solve on it, as messages of the
// contract: a v1.Skeleton, a line "---", and a v1.Session, whose goals, options
// and pose are those of SolveInverseKinematics and of CreateSession. What is
// refused is refused decently; what is solved holds what solve_check.h says,
// and its answer fits into the contract again.
//
// Text rather than the wire's bytes: most changes of those are no message at
// all, and what a message may hold can be written either way.

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "convert/geometry.h"
#include "convert/goal.h"
#include "convert/pose.h"
#include "convert/skeleton.h"
#include "convert/solver.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/v1/session.pb.h"
#include "gelenk/v1/skeleton.pb.h"
#include "tests/fuzz/fuzz_check.h"
#include "tests/fuzz/solve_check.h"

namespace gelenk {
namespace {

// Small, so that a fuzzer makes many runs a second.
constexpr SkeletonBounds kBounds = {
    .max_joints = 24, .max_depth = 24, .max_end_effectors = 24};
constexpr int kMostGoals = 6;
constexpr int kMostIterations = 24;
constexpr int kMostRestarts = 2;

// Twenty lines.
constexpr size_t kMaxMessageBytes = 8192;

class Silence : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int, int, const std::string&) override {}
};

bool Parse(absl::string_view text, google::protobuf::Message* message) {
  Silence silence;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&silence);
  return parser.ParseFromString(std::string(text), message);
}

// OK, or a decent refusal.
bool IsTaken(const absl::Status& status) {
  if (status.ok()) return true;
  CheckRefusal(status, kMaxMessageBytes);
  return false;
}

// What goes out comes in again as it was.
void CheckRoundTrip(const IkProblem& problem) {
  v1::Session proto;
  convert::ToProto(problem.goals(), proto.mutable_goals());
  const auto goals = convert::FromProto(proto.goals(), &problem.skeleton());
  GELENK_FUZZ_CHECK(goals.ok());
  v1::Session again;
  convert::ToProto(*goals, again.mutable_goals());
  GELENK_FUZZ_CHECK(again.DebugString() == proto.DebugString());
}

void CheckAnswer(const Eigen::VectorXd& positions, const SolveReport& report,
                 const SolverOptions& options, const Skeleton& skeleton) {
  v1::SolveReport proto;
  convert::ToProto(report, options.detail, absl::ZeroDuration(), &proto);
  GELENK_FUZZ_CHECK(proto.outcome() != v1::SolveReport::OUTCOME_UNSPECIFIED);
  GELENK_FUZZ_CHECK(std::isfinite(proto.change()));
  v1::Pose pose;
  convert::ToProto(positions, &pose);
  GELENK_FUZZ_CHECK(convert::FromProto(skeleton, pose).ok());
}

void Solve(IkProblem& problem, SolverOptions options, SolveStart from,
           const Eigen::VectorXd& start) {
  options.max_iterations = std::min(options.max_iterations, kMostIterations);
  options.max_restarts =
      std::min(options.max_restarts.value_or(kMostRestarts), kMostRestarts);
  IkSolver solver;
  const Eigen::VectorXd answer =
      CheckSolve(solver, problem, options, from, start);
  SolveReport report;
  Eigen::VectorXd positions = answer;
  solver.Solve(problem, options, SolveStart::kWarm, positions, report);
  CheckPose(problem.skeleton(), positions);
  CheckReport(problem, options, report);
  CheckAnswer(positions, report, options, problem.skeleton());
}

// As the service reads it: all that is wrong is listed at once.
void Run(const v1::Session& proto, std::shared_ptr<const Skeleton> skeleton) {
  Violations violations;
  absl::StatusOr<std::vector<Goal>> goals =
      convert::FromProto(proto.goals(), skeleton.get());
  violations.AddStatus("", goals.status());
  const absl::StatusOr<SolverOptions> options =
      convert::FromProto(proto.solver_options());
  violations.AddStatus("solver_options", options.status());
  RigidTransform place = convert::FromProto(proto.world_from_skeleton());
  CheckAndNormalize("world_from_skeleton", place, violations);
  absl::StatusOr<Eigen::VectorXd> start = skeleton->rest_positions();
  if (proto.has_pose()) start = convert::FromProto(*skeleton, proto.pose());
  violations.AddStatus("pose", start.status());
  if (!goals.ok()) {
    GELENK_FUZZ_CHECK(!IsTaken(violations.ToStatus()));
    return;
  }
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(skeleton, *std::move(goals));
  violations.AddStatus("", problem.status());
  if (!IsTaken(violations.ToStatus())) return;
  if (!IsTaken(IkSolver::Check(*problem, *options))) return;
  problem->SetWorldFromSkeleton(place);
  CheckRoundTrip(*problem);
  Solve(*problem, *options,
        proto.has_pose() ? SolveStart::kWarm : SolveStart::kCold, *start);
}

void Run(absl::string_view text) {
  constexpr absl::string_view kRule = "---\n";
  const size_t rule = text.find(kRule);
  if (rule == absl::string_view::npos) return;
  v1::Skeleton skeleton_proto;
  v1::Session session;
  if (!Parse(text.substr(0, rule), &skeleton_proto)) return;
  if (!Parse(text.substr(rule + kRule.size()), &session)) return;
  const auto skeleton = convert::FromProto(skeleton_proto, kBounds);
  if (!IsTaken(skeleton.status())) return;
  if (session.goals_size() > kMostGoals) return;
  Run(session, *skeleton);
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
