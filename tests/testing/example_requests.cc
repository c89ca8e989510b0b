#include "tests/testing/example_requests.h"

#include <cmath>

#include "convert/skeleton.h"
#include "tests/testing/example_skeletons.h"

namespace gelenk::testing {
namespace {

void SetTurnAboutZ(double angle_rad, v1::Quaternion* rotation) {
  rotation->set_z(std::sin(angle_rad / 2));
  rotation->set_w(std::cos(angle_rad / 2));
}

}  // namespace

v1::CreateSkeletonRequest ArmSkeletonRequest() {
  v1::CreateSkeletonRequest request;
  request.set_skeleton_id("planar-arm");
  convert::ToProto(*PlanarChain(Eigen::Vector3d::Zero(), {0.5, 0.5, 0.5}),
                   request.mutable_skeleton());
  return request;
}

v1::CreateSessionRequest ArmSessionRequest(const std::string& id) {
  v1::CreateSessionRequest request;
  request.set_session_id(id);
  v1::Session* session = request.mutable_session();
  session->set_skeleton("skeletons/planar-arm");
  for (double angle_rad : {0.1, 0.2, 0.3}) {
    session->mutable_pose()->add_positions(angle_rad);
  }
  v1::Goal* reach = session->add_goals();
  reach->set_goal_id("reach");
  reach->mutable_position()->set_end_effector_id("tip");
  reach->mutable_position()->mutable_world_position()->set_x(0.9);
  v1::Goal* aim = session->add_goals();
  aim->set_goal_id("aim");
  aim->set_weight(0.01);
  aim->mutable_rotation()->set_end_effector_id("j1");
  SetTurnAboutZ(0.5, aim->mutable_rotation()->mutable_world_rotation());
  return request;
}

v1::AttachSession AttachRequest(const std::string& session) {
  v1::AttachSession attach;
  attach.set_session(session);
  attach.set_frame_policy(v1::FRAME_POLICY_EVERY_FRAME);
  return attach;
}

v1::TargetFrame ReachFrame(int64_t sequence_number, double x_m, double y_m,
                           int slot) {
  v1::TargetFrame frame;
  frame.set_slot(slot);
  frame.set_sequence_number(sequence_number);
  v1::GoalTarget* target = frame.add_targets();
  target->set_goal_index(kReachGoal);
  target->mutable_world_position()->set_x(x_m);
  target->mutable_world_position()->set_y(y_m);
  return frame;
}

v1::TargetFrame WholeFrame(int64_t sequence_number, int slot) {
  const double phase_rad = 0.1 * static_cast<double>(sequence_number);
  v1::TargetFrame frame =
      ReachFrame(sequence_number, 0.8 + 0.3 * std::cos(phase_rad),
                 0.4 * std::sin(phase_rad), slot);
  v1::GoalTarget* aim = frame.add_targets();
  aim->set_goal_index(kAimGoal);
  SetTurnAboutZ(0.5 * std::sin(phase_rad), aim->mutable_world_rotation());
  return frame;
}

}  // namespace gelenk::testing
