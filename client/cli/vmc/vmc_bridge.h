// From one performer to another body: VMC in, a session that retargets, VMC
// out.
//
//   UDP -> VmcReader -> VmcPerformer -> session -> VmcWriter -> UDP
//
// The session is made of the first frame that shows a body, and made anew when
// a performer comes whose bones are others. Frames go out as poses come in; of
// those that come too fast the newest counts. With a fill interval the body
// comes to rest when none come any more, a frame each interval.
#ifndef CLIENT_CLI_VMC_VMC_BRIDGE_H_
#define CLIENT_CLI_VMC_VMC_BRIDGE_H_

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "client/cli/motion/body_file.h"
#include "client/cli/vmc/udp_socket.h"
#include "client/cli/vmc/vmc_performer.h"
#include "client/cli/vmc/vmc_reader.h"
#include "client/cli/vmc/vmc_writer.h"
#include "gelenk/client/connection.h"
#include "gelenk/client/session_stream.h"
#include "gelenk/retarget/humanoid.h"

namespace gelenk::cli {

struct VmcBridgeCounts {
  int64_t packets = 0;
  int64_t malformed_packets = 0;
  int64_t refused_messages = 0;
  int64_t frames_in = 0;
  int64_t frames_out = 0;
  int64_t refused_frames = 0;
};

// Trackers that are followed in place of bones.
struct VmcTrackers {
  // Of serials, which of kTrackerIds each is.
  std::map<std::string, std::string> part_of_serial;
  double height_m = kHumanoidHeightM;
  // The first frame that has them all shows a T-pose.
  bool begins_in_t_pose = false;
};

class VmcBridge {
 public:
  VmcBridge(std::shared_ptr<client::Connection> connection, BodyFile target,
            std::unique_ptr<UdpSocket> in, std::unique_ptr<UdpSocket> out,
            std::optional<VmcTrackers> trackers = std::nullopt,
            std::optional<absl::Duration> fill_interval = std::nullopt);
  // Deletes the session.
  ~VmcBridge();

  // Bridges until `stop` is set or `deadline` is over. Errors: those of the
  // service. What comes from the network is never one.
  absl::Status Run(absl::Time deadline, const std::atomic<bool>& stop);

  const VmcBridgeCounts& counts() const { return counts_; }

 private:
  // Takes what has come, as far as it makes a whole frame; true then.
  bool ReceiveFrame();
  // Opens a session that fits the frame, where there is none. No session after
  // it: the frame does not show enough.
  absl::Status FollowBones(const VmcFrame& frame);
  absl::Status FollowTrackers(const VmcFrame& frame);
  absl::Status Open(client::SessionSpec spec);
  v1::TargetFrame FrameOfTrackers(const VmcFrame& frame) const;
  absl::Status SendFrame();
  // Sends the poses that have come.
  absl::Status Answer(absl::Duration timeout);
  void Close();

  const std::shared_ptr<client::Connection> connection_;
  const BodyFile target_;
  const std::unique_ptr<UdpSocket> in_;
  const std::unique_ptr<UdpSocket> out_;
  const std::optional<VmcTrackers> trackers_;
  const std::optional<absl::Duration> fill_interval_;
  const absl::Time start_;
  VmcReader reader_;
  VmcWriter writer_;
  std::optional<VmcPerformer> performer_;
  client::SessionSpec spec_;
  std::unique_ptr<client::SessionStream> stream_;
  std::string packet_;
  VmcBridgeCounts counts_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_VMC_BRIDGE_H_
