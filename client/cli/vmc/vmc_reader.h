// What a performer does, from the messages of the VMC protocol.
//
// Bones and trackers come one by one; /VMC/Ext/OK or /VMC/Ext/T, or a bone that
// comes again, ends a frame. Everything is turned into our axes. Unknown
// messages and bones are left out, malformed ones too, and counted.
#ifndef CLIENT_CLI_VMC_VMC_READER_H_
#define CLIENT_CLI_VMC_VMC_READER_H_

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "client/cli/vmc/human_bone.h"
#include "client/cli/vmc/osc_packet.h"
#include "gelenk/math/rigid_transform.h"

namespace gelenk::cli {

struct VmcFrame {
  // Of the performer in the room.
  RigidTransform root;
  // parent_from_bone, turned from the T-pose; unset never came.
  std::array<std::optional<RigidTransform>, kHumanBoneCount> bones;
  // Headset, controllers and trackers in the room, by their serials.
  std::map<std::string, RigidTransform> trackers;
};

// More serials than a room has devices are noise.
inline constexpr size_t kMaxVmcTrackers = 64;

class VmcReader {
 public:
  // True when the message ends a frame that brought something. What bones and
  // trackers the frame did not bring is as in the one before.
  bool Take(const OscMessage& message);

  const VmcFrame& frame() const { return frame_; }
  // Messages of the protocol with arguments that it does not know, bones that
  // nobody has, numbers that are none.
  int64_t refused_count() const { return refused_count_; }

 private:
  bool TakeBone(const OscMessage& message);
  void TakeTracker(const OscMessage& message);
  // Ends the frame; whether there was something in it.
  bool End();

  // `next_` is filled, `frame_` is whole.
  VmcFrame next_;
  VmcFrame frame_;
  std::array<bool, kHumanBoneCount> brought_ = {};
  bool has_any_ = false;
  int64_t refused_count_ = 0;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_VMC_READER_H_
