// A clip that was played through a service: what was asked, what came back.
#ifndef CLIENT_CLI_PLAY_PLAYBACK_H_
#define CLIENT_CLI_PLAY_PLAYBACK_H_

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "client/cli/tolerance.h"
#include "gelenk/ik/goal.h"
#include "gelenk/ik/solve_report.h"
#include "gelenk/motion/body_parts.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

// One answer of the service.
struct Answer {
  // False when the frame was merged into a later one, or its answer is an
  // error: then `error` says which and nothing else is set.
  bool answered = false;
  std::string error;
  SolveOutcome outcome = SolveOutcome::kConverged;
  // As the service reports them, per goal.
  std::vector<double> position_errors_m;
  std::vector<double> rotation_errors_rad;
  int iteration_count = 0;
  int restart_count = 0;
  int merged_frame_count = 0;
  absl::Duration solve_duration;
};

// From handing a frame over to having its answer, waits in queues included.
struct RoundTrip {
  absl::Duration p50;
  absl::Duration p99;
  absl::Duration max;
};

struct Playback {
  std::string clip_name;
  // With the limits that the service was given.
  std::shared_ptr<const Skeleton> skeleton;
  BodyParts body;
  absl::Duration frame_time;
  Tolerance tolerance;
  // The goals, with the targets of the first frame.
  std::vector<Goal> goals;
  // position_count rows, one column a frame: the clip, and the answers. A frame
  // without an answer keeps the pose of the one before.
  Eigen::MatrixXd clip_poses;
  Eigen::MatrixXd answered_poses;
  // One a frame.
  std::vector<Answer> answers;
  absl::Duration elapsed;
  RoundTrip round_trip;
  int64_t reconnects = 0;

  int frame_count() const { return static_cast<int>(answers.size()); }
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_PLAYBACK_H_
