// Plays a clip through a service, as a live actor would: frame after frame the
// targets go out on one stream, and joint angles come back.
#ifndef CLIENT_CLI_PLAY_CLIP_PLAYER_H_
#define CLIENT_CLI_PLAY_CLIP_PLAYER_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cli/play/playback.h"
#include "gelenk/client/connection.h"
#include "gelenk/v1/session_service.pb.h"

namespace gelenk::cli {

struct PlayerOptions {
  v1::FramePolicy policy = v1::FRAME_POLICY_EVERY_FRAME;
  // Frames under way at a time; those that wait go out together. 1 waits for
  // each answer before the next frame.
  int batch = 32;
  // Frames a second; unset means as fast as answers come.
  std::optional<double> fps;
  // Where the log of the session goes; empty for none.
  std::string record_path;
};

// Creates skeleton and session, plays `playback.clip_poses`, fills in the
// answers, and deletes what it created. `playback` has its skeleton, goals,
// tolerance and clip. The first solve is a cold one, from the rest pose.
// `report_progress` is told the frames answered so far. Errors: those of the
// service, or of a connection that stays away.
absl::Status PlayClip(const std::shared_ptr<client::Connection>& connection,
                      const PlayerOptions& options,
                      const std::function<void(int)>& report_progress,
                      Playback* playback);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_CLIP_PLAYER_H_
