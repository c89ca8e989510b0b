// Packets of Open Sound Control: messages, alone or in bundles.
//
// Checked like any input from a network; see http://opensoundcontrol.org. By
// liblo, which knows the form of a message.
#ifndef CLIENT_CLI_VMC_OSC_PACKET_H_
#define CLIENT_CLI_VMC_OSC_PACKET_H_

#include <string>
#include <variant>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace gelenk::cli {

using OscArgument = std::variant<int, float, std::string>;

struct OscMessage {
  std::string path;
  std::vector<OscArgument> arguments;
};

// UDP carries no more.
inline constexpr size_t kMaxOscPacketBytes = 65536;

// Calls `take` for every message of the packet, in order; arguments that are no
// number and no text are left out. INVALID_ARGUMENT where the packet is
// malformed: what stands before the fault has been taken.
absl::Status ReadOscPacket(
    absl::string_view packet,
    absl::FunctionRef<void(const OscMessage& message)> take);

// One bundle of all messages.
std::string WriteOscBundle(const std::vector<OscMessage>& messages);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_OSC_PACKET_H_
