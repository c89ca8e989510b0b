#include "tests/testing/example_sessions.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/rpc/session_message.h"
#include "tests/testing/example_skeletons.h"

namespace gelenk::testing {
namespace {

using server::InputFrame;
using server::Session;
using server::SessionState;
using server::SharedTrees;

// Where "aim" and "grip" are from the start.
Eigen::Quaterniond QuarterTurnAboutZ() {
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()));
}

}  // namespace

std::vector<Goal> ArmGoals() {
  RotationGoal aim;
  aim.end_effector_id = "j1";
  aim.world_rotation = QuarterTurnAboutZ();
  PoseGoal grip;
  grip.end_effector_id = "tip";
  grip.world_pose = {QuarterTurnAboutZ(), {0.8, 0.6, 0}};
  return {{"reach", 1, PositionGoal{"tip", {0.9, 0.5, 0}, {}}},
          {"aim", 0.01, aim},
          {"grip", 0.1, grip}};
}

namespace {

std::shared_ptr<Session> MakeArmSession(std::string name, absl::Time now,
                                        std::vector<Goal> goals,
                                        SessionState state) {
  const auto trees = std::make_shared<SharedTrees>(
      PlanarChain(Eigen::Vector3d::Zero(), {0.5, 0.5, 0.5}));
  absl::StatusOr<IkProblem> problem = trees->CreateProblem(goals);
  state.goals = std::move(goals);
  if (state.positions.size() == 0) {
    state.positions = Eigen::Vector3d(0.1, 0.2, 0.3);
    state.cold = false;
  }
  return std::make_shared<Session>(std::move(name), "skeletons/arm", "arm",
                                   trees, *std::move(problem), state, now);
}

}  // namespace

std::shared_ptr<Session> ArmSession(absl::Time now) {
  return ArmSession(now, ArmGoals());
}

std::shared_ptr<Session> ArmSession(absl::Time now, std::vector<Goal> goals,
                                    SessionState state) {
  return MakeArmSession("sessions/arm", now, std::move(goals),
                        std::move(state));
}

std::shared_ptr<Session> ArmSessionNamed(std::string name, absl::Time now) {
  return MakeArmSession(std::move(name), now, ArmGoals(), {});
}

InputFrame ReachFrame(int64_t sequence_number, double x_m, double y_m) {
  InputFrame frame;
  frame.sequence_number = sequence_number;
  frame.updates = {{kReach, Eigen::Vector3d(x_m, y_m, 0), {}}};
  return frame;
}

InputFrame WholeFrame(int64_t sequence_number, double x_m, double y_m) {
  InputFrame frame = ReachFrame(sequence_number, x_m, y_m);
  frame.updates.push_back({kAim, QuarterTurnAboutZ(), {}});
  frame.updates.push_back(
      {kGrip, RigidTransform{QuarterTurnAboutZ(), {x_m, y_m, 0}}, {}});
  return frame;
}

std::string StateOf(const Session& session) {
  v1::Session proto;
  server::ToProto(session, /*draining=*/false, &proto);
  proto.clear_create_time();
  proto.clear_expire_time();
  return absl::StrCat(proto.DebugString(), session.sequence_number());
}

}  // namespace gelenk::testing
