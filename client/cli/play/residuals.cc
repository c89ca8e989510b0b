#include "client/cli/play/residuals.h"

#include <algorithm>
#include <cmath>

#include "client/cli/play/clip_goals.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk::cli {
namespace {

void NoteLimits(const Playback& playback, int frame, Residuals& residuals) {
  int joint = -1;
  const double excess = LimitExcess(*playback.skeleton,
                                    playback.answered_poses.col(frame), &joint);
  if (excess <= residuals.limit_excess) return;
  residuals.limit_excess = excess;
  residuals.limit_joint_id = playback.skeleton->joint(joint).id;
}

// What `reported` says of goal `i`; the measured value where it says nothing.
double Reported(const std::vector<double>& reported, size_t i,
                double measured) {
  return i < reported.size() ? reported[i] : measured;
}

void NoteGoal(const Answer& answer, size_t goal, const GoalError& error,
              int frame, Residuals& residuals) {
  double& position = residuals.position_m[frame];
  double& rotation = residuals.rotation_rad[frame];
  position = std::max(position, error.position_m);
  rotation = std::max(rotation, error.rotation_rad);
  residuals.disagreement_m =
      std::max(residuals.disagreement_m,
               std::abs(error.position_m - Reported(answer.position_errors_m,
                                                    goal, error.position_m)));
  residuals.disagreement_rad = std::max(
      residuals.disagreement_rad,
      std::abs(error.rotation_rad -
               Reported(answer.rotation_errors_rad, goal, error.rotation_rad)));
}

}  // namespace

Residuals MeasureResiduals(const Playback& playback) {
  Residuals residuals;
  residuals.position_m.resize(playback.frame_count(), 0);
  residuals.rotation_rad.resize(playback.frame_count(), 0);
  WorldTransforms clip_frames;
  WorldTransforms answered_frames;
  std::vector<GoalTarget> targets;
  for (int frame = 0; frame < playback.frame_count(); ++frame) {
    const Answer& answer = playback.answers[frame];
    if (!answer.answered) continue;
    NoteLimits(playback, frame, residuals);
    ForwardKinematics(*playback.skeleton, playback.clip_poses.col(frame),
                      clip_frames);
    ForwardKinematics(*playback.skeleton, playback.answered_poses.col(frame),
                      answered_frames);
    TargetsAt(*playback.skeleton, playback.goals, clip_frames, targets);
    for (size_t i = 0; i < playback.goals.size(); ++i) {
      NoteGoal(answer, i,
               ErrorOf(*playback.skeleton, playback.goals[i], targets[i],
                       answered_frames),
               frame, residuals);
    }
  }
  return residuals;
}

}  // namespace gelenk::cli
