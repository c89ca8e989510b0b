#include "server/session/source_motion.h"

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/retarget/tracker_goals.h"

namespace gelenk::server {
namespace {

// The weight that goal `index` has once the frame is taken.
double WeightAfter(const IkProblem& problem, const InputFrame& frame,
                   int index) {
  double weight = problem.goals()[index].weight;
  for (const GoalUpdate& update : frame.updates) {
    if (update.goal_index == index && update.weight) weight = *update.weight;
  }
  return weight;
}

bool TracksHead(const IkProblem& problem, const InputFrame& frame) {
  for (size_t i = 0; i < problem.goals().size(); ++i) {
    if (problem.goals()[i].id != kTrackerIds[0]) continue;
    return WeightAfter(problem, frame, static_cast<int>(i)) > 0;
  }
  return false;
}

}  // namespace

absl::Status SourceMotion::CheckGoals(absl::Span<const Goal> goals) const {
  if (retargeter_->takes_trackers()) return CheckTrackerGoals(goals);
  if (goals.empty()) return absl::OkStatus();
  Violations violations;
  violations.Add("goals", absl::StrCat("want none in a session that follows ",
                                       skeleton_name_, ", got ", goals.size()));
  return violations.ToStatus();
}

absl::Status SourceMotion::CheckFrame(const IkProblem& problem,
                                      bool may_be_missing,
                                      InputFrame& frame) const {
  Violations violations;
  violations.AddStatus("", retargeter_->CheckTime(frame.motion_time));
  if (retargeter_->takes_trackers()) {
    if (frame.has_source_pose) {
      violations.Add("source_pose", "want trackers, got a pose");
    }
    if (!TracksHead(problem, frame) && !retargeter_->KnowsHead()) {
      violations.Add("targets", "the head has never been tracked");
    }
  } else if (!frame.has_source_pose && !may_be_missing) {
    violations.Add("source_pose",
                   absl::StrCat("want a pose of ", skeleton_name_));
  } else if (frame.has_source_pose) {
    violations.AddStatus("source_pose",
                         retargeter_->CheckPose(frame.source_pose));
  }
  return violations.ToStatus();
}

void SourceMotion::Take(const InputFrame& frame) {
  retargeter_->NoteFrame(frame.motion_time);
  if (frame.has_source_pose) pose_ = frame.source_pose;
}

void SourceMotion::Step(const IkProblem& problem, Eigen::VectorXd& positions) {
  if (retargeter_->takes_trackers()) {
    const RigidTransform canonical_from_skeleton = {
        retargeter_->target().canonical_from_world, Eigen::Vector3d::Zero()};
    retargeter_->Step(TrackersOf(
        problem.goals(),
        canonical_from_skeleton * problem.world_from_skeleton().Inverse()));
  } else {
    retargeter_->Step(pose_);
  }
  positions = retargeter_->positions();
}

}  // namespace gelenk::server
