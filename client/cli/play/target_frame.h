// Frames of a clip as messages to the service.
#ifndef CLIENT_CLI_PLAY_TARGET_FRAME_H_
#define CLIENT_CLI_PLAY_TARGET_FRAME_H_

#include <vector>

#include "client/cli/play/playback.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::cli {

// Not thread-safe: holds working memory.
class TargetFrameWriter {
 public:
  // Outlives the writer.
  explicit TargetFrameWriter(const Playback& playback) : playback_(playback) {}

  // Every goal's target where the clip's pose has it; the capture time is that
  // of the frame, its sequence number the frame's plus one.
  v1::TargetFrame Write(int frame);

 private:
  const Playback& playback_;
  WorldTransforms world_from_joints_;
  std::vector<GoalTarget> targets_;
};

// The session to create: goals, tolerance, a short life.
v1::Session SessionFor(const Playback& playback);

// Takes an answer into `playback`. INTERNAL when it does not fit the skeleton.
absl::Status TakeAnswer(const v1::PoseFrame& answer, Playback* playback);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_TARGET_FRAME_H_
