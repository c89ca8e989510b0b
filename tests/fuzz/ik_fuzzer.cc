// Any bytes say a tree of joints of all types, goals of every kind, options and
// a start; what is refused is refused decently and leaves everything as it was,
// and what is solved holds what solve_check.h says.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/fuzz_check.h"
#include "tests/fuzz/solve_check.h"

namespace gelenk {
namespace {

// Small, so that a fuzzer makes many runs a second.
constexpr int kMostJoints = 20;
constexpr int kMostGoals = 6;
constexpr int kMostIterations = 24;
constexpr int kMostRestarts = 3;

// Twenty lines.
constexpr size_t kMaxMessageBytes = 8192;

JointLimits ReadLimits(ByteSource& bytes, JointType type) {
  JointLimits limits;
  const bool turns = type == JointType::kSpherical || type == JointType::kFree;
  const bool cone = turns && bytes.OneIn(2);
  const bool twist = turns && bytes.OneIn(2);
  if (cone) limits.swing_cone_rad = std::abs(bytes.Number()) * 0.75;
  if (twist) {
    limits.twist_lower_rad = -std::abs(bytes.Number());
    limits.twist_upper_rad = std::abs(bytes.Number());
  }
  const int bounded = type == JointType::kSpherical ? 0
                      : type == JointType::kFree    ? 3
                                                    : PositionCount(type);
  if (bytes.OneIn(4)) return limits;
  for (int i = 0; i < bounded; ++i) {
    const double a = bytes.Number();
    const double b = bytes.OneIn(8) ? a : bytes.Number();
    limits.lower.push_back(std::min(a, b));
    limits.upper.push_back(std::max(a, b));
  }
  return limits;
}

Joint ReadJoint(ByteSource& bytes, int index, bool flat) {
  constexpr JointType kTypes[] = {JointType::kRevolute,  JointType::kRevolute,
                                  JointType::kPrismatic, JointType::kSpherical,
                                  JointType::kPlanar,    JointType::kFree,
                                  JointType::kFixed,     JointType::kRevolute};
  Joint joint;
  joint.id = absl::StrCat("j", index);
  const auto earlier = [&] {
    const int reach = bytes.GoWrong() ? index + 1 : std::max(1, index);
    return absl::StrCat("j", bytes.Below(reach));
  };
  if (index > 0) {
    joint.parent_id = bytes.OneIn(4) ? earlier() : absl::StrCat("j", index - 1);
  }
  joint.type = flat ? kTypes[bytes.Below(2)] : kTypes[bytes.Below(8)];
  joint.parent_from_joint = bytes.Transform(1);
  joint.axis =
      flat ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : bytes.Direction();
  if (bytes.OneIn(2)) joint.limits = ReadLimits(bytes, joint.type);
  if (bytes.OneIn(8)) {
    for (int i = 0; i < VelocityCount(joint.type); ++i) {
      joint.stiffness.push_back(std::abs(bytes.Number()));
    }
  }
  if (bytes.OneIn(8)) {
    joint.link_mass_kg = std::abs(bytes.Number());
    joint.link_center_of_mass = bytes.Vector(1);
  }
  return joint;
}

// Whether `joint` may follow another or be followed.
bool IsScalar(const Joint& joint) {
  return joint.type == JointType::kRevolute ||
         joint.type == JointType::kPrismatic;
}

SkeletonBuilder ReadSkeleton(ByteSource& bytes) {
  SkeletonBuilder builder;
  const int joints = 1 + bytes.Below(kMostJoints);
  const bool flat = bytes.OneIn(4);
  std::vector<std::string> leaders;
  for (int i = 0; i < joints; ++i) {
    Joint joint = ReadJoint(bytes, i, flat);
    const bool follows = bytes.OneIn(8) && !leaders.empty();
    if (follows && (IsScalar(joint) || bytes.GoWrong())) {
      const size_t leader = bytes.Below(static_cast<int>(leaders.size()));
      const double multiplier = bytes.Number();
      joint.mimic = {leaders[leader], multiplier, bytes.Number()};
    } else if (IsScalar(joint) || bytes.GoWrong()) {
      leaders.push_back(joint.id);
    }
    builder.AddJoint(std::move(joint));
  }
  builder.AddEndEffector(
      {"tip", absl::StrCat("j", joints - 1), bytes.Transform(1)});
  return builder;
}

std::string ReadEffector(ByteSource& bytes, const Skeleton& skeleton) {
  if (bytes.OneIn(2)) return "tip";
  return skeleton.joint(bytes.Below(skeleton.joint_count())).id;
}

AxisMask ReadMask(ByteSource& bytes) {
  if (!bytes.OneIn(4)) return {};
  const int mask = bytes.Below(8);
  return {(mask & 1) != 0, (mask & 2) != 0, (mask & 4) != 0};
}

Eigen::VectorXd ReadPositions(ByteSource& bytes, const Skeleton& skeleton) {
  Eigen::VectorXd positions = skeleton.rest_positions();
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const JointSpan& span = skeleton.span(j);
    if (span.position_offset < 0) continue;
    const int count = PositionCount(skeleton.joint(j).type);
    for (int i = 0; i < count; ++i) {
      positions[span.position_offset + i] = bytes.Number();
    }
    if (span.quaternion_offset < 0) continue;
    auto quaternion = positions.segment<4>(span.quaternion_offset);
    if (quaternion.norm() > 0) quaternion.normalize();
  }
  return positions;
}

// Joints of the tip's path, if it is long enough.
PoleGoal ReadPole(ByteSource& bytes, const Skeleton& skeleton) {
  std::vector<int> path;
  for (int j = skeleton.joint_count() - 1; j >= 0;
       j = skeleton.span(j).parent) {
    path.push_back(j);
  }
  const int last = static_cast<int>(path.size()) - 1;
  const int mid = std::min(last, 1 + bytes.Below(std::max(1, last - 1)));
  return {skeleton.joint(path[last]).id, skeleton.joint(path[mid]).id,
          skeleton.joint(path[0]).id, bytes.Vector(4)};
}

GoalKind ReadKind(ByteSource& bytes, const Skeleton& skeleton) {
  const std::string id = ReadEffector(bytes, skeleton);
  switch (bytes.Below(12)) {
    case 0:
    case 1:
      return PositionGoal{id, bytes.Vector(4), ReadMask(bytes)};
    case 2:
      return RotationGoal{id, bytes.Rotation(), ReadMask(bytes)};
    case 3:
    case 4:
      return PoseGoal{id, bytes.Transform(4), std::abs(bytes.Number()),
                      ReadMask(bytes), ReadMask(bytes)};
    case 5:
      return AimGoal{id, bytes.Vector(1), bytes.Vector(4)};
    case 6:
      return ReadPole(bytes, skeleton);
    case 7:
      return RelativeGoal{ReadEffector(bytes, skeleton), id, bytes.Transform(2),
                          std::abs(bytes.Number())};
    case 8:
      return CenterOfMassGoal{bytes.Vector(4), ReadMask(bytes)};
    case 9:
      return PostureGoal{ReadPositions(bytes, skeleton), {}};
    case 10:
      return HalfSpaceGoal{id, bytes.Vector(1), bytes.Number(), bytes.OneIn(2)};
    default:
      return PlantGoal{id, std::abs(bytes.Number())};
  }
}

std::vector<Goal> ReadGoals(ByteSource& bytes, const Skeleton& skeleton) {
  std::vector<Goal> goals(bytes.Below(kMostGoals + 1));
  const bool levels = bytes.OneIn(4);
  for (size_t g = 0; g < goals.size(); ++g) {
    goals[g].id = absl::StrCat("g", g);
    goals[g].kind = ReadKind(bytes, skeleton);
    if (bytes.OneIn(4)) goals[g].weight = std::abs(bytes.Number());
    if (levels) goals[g].priority = bytes.Below(4);
  }
  return goals;
}

SolverOptions ReadOptions(ByteSource& bytes) {
  constexpr SolverMethod kMethods[] = {
      SolverMethod::kAuto,          SolverMethod::kAuto,
      SolverMethod::kAuto,          SolverMethod::kTwoLink,
      SolverMethod::kNewton,        SolverMethod::kPseudoInverse,
      SolverMethod::kMinimalChange, SolverMethod::kFabrik};
  SolverOptions options;
  options.method = kMethods[bytes.Below(8)];
  options.max_iterations = bytes.Below(kMostIterations + 1);
  options.max_restarts = bytes.Below(kMostRestarts + 1);
  options.restart_seed = bytes.Byte();
  if (bytes.OneIn(2)) options.position_tolerance_m = 1e-6;
  if (bytes.OneIn(4)) options.position_tolerance_m = std::abs(bytes.Number());
  if (bytes.OneIn(4)) options.rotation_tolerance_rad = std::abs(bytes.Number());
  options.detail = static_cast<ReportDetail>(bytes.Below(3));
  if (bytes.OneIn(4)) options.max_step = std::abs(bytes.Number());
  return options;
}

// Targets that are refused leave the problem as it is.
void CheckBadTargets(IkProblem& problem) {
  for (size_t g = 0; g < problem.goals().size(); ++g) {
    GoalTarget target = TargetOf(problem.goals()[g].kind);
    auto* point = std::get_if<Eigen::Vector3d>(&target);
    if (point == nullptr) continue;
    point->y() = NAN;
    const int goal = static_cast<int>(g);
    CheckRefusal(problem.CheckTarget(goal, target), kMaxMessageBytes);
  }
}

// What was asked for, all of it taken.
struct Request {
  SolverOptions options;
  SolveStart from;
  InstructionSet level;
  bool in_batches;
  Eigen::VectorXd start;
};

void Solve(const Request& request, IkProblem& problem) {
  IkSolver solver(request.level);
  const Eigen::VectorXd answer =
      CheckSolve(solver, problem, request.options, request.from, request.start);
  CheckBadTargets(problem);
  CheckSolve(solver, problem, request.options, SolveStart::kWarm, answer);
  if (!request.in_batches) return;
  Eigen::MatrixXd starts(answer.size(), 3);
  starts << request.start, answer, request.start;
  CheckBatch(problem, request.options, request.from, starts);
}

// OK, or a decent refusal.
bool IsTaken(const absl::Status& status) {
  if (status.ok()) return true;
  CheckRefusal(status, kMaxMessageBytes);
  return false;
}

void Run(ByteSource bytes) {
  const std::vector<InstructionSet> levels = SupportedInstructionSets();
  Request request;
  request.options = ReadOptions(bytes);
  request.from = bytes.OneIn(2) ? SolveStart::kCold : SolveStart::kWarm;
  request.level = levels[bytes.Below(static_cast<int>(levels.size()))];
  request.in_batches = bytes.OneIn(4);
  RigidTransform world_from_skeleton = bytes.Transform(2);
  Violations violations;
  CheckAndNormalize("world_from_skeleton", world_from_skeleton, violations);
  violations.AddStatus("options", CheckSolverOptions(request.options));
  if (!IsTaken(violations.ToStatus())) return;

  const auto skeleton = ReadSkeleton(bytes).Build();
  if (!IsTaken(skeleton.status())) return;
  request.start = ReadPositions(bytes, **skeleton);
  if (!IsTaken(CheckPositions(**skeleton, request.start))) return;
  absl::StatusOr<IkProblem> problem =
      IkProblem::Create(*skeleton, ReadGoals(bytes, **skeleton));
  if (!IsTaken(problem.status())) return;
  if (!IsTaken(IkSolver::Check(*problem, request.options))) return;
  problem->SetWorldFromSkeleton(world_from_skeleton);
  Solve(request, *problem);
}

}  // namespace
}  // namespace gelenk

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  gelenk::Run(gelenk::ByteSource(data, size));
  return 0;
}
