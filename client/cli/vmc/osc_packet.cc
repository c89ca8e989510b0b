#include "client/cli/vmc/osc_packet.h"

#include <lo/lo.h>

#include <cstdint>
#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace gelenk::cli {
namespace {

// "#bundle" with its end, then a time.
constexpr absl::string_view kBundle("#bundle\0", 8);
constexpr size_t kHeadBytes = 16;
// Senders put messages into a bundle, not bundles into bundles.
constexpr int kMaxDepth = 4;

struct FreeMessage {
  void operator()(void* message) const { lo_message_free(message); }
};
using Message = std::unique_ptr<void, FreeMessage>;

absl::Status Malformed(absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("OSC: ", why));
}

uint32_t BigEndian(const char* bytes) {
  const auto* b = reinterpret_cast<const unsigned char*>(bytes);
  return uint32_t{b[0]} << 24 | uint32_t{b[1]} << 16 | uint32_t{b[2]} << 8 |
         uint32_t{b[3]};
}

absl::Status ReadMessage(absl::string_view packet,
                         absl::FunctionRef<void(const OscMessage&)> take) {
  // liblo turns the bytes round in place.
  std::string bytes(packet);
  int error = 0;
  const Message message(
      lo_message_deserialise(bytes.data(), bytes.size(), &error));
  if (message == nullptr) {
    return Malformed(absl::StrCat("no message (", error, ")"));
  }
  OscMessage read;
  // The path stands in front, with its end, as liblo has seen.
  read.path = std::string(packet.substr(0, packet.find('\0')));
  const char* types = lo_message_get_types(message.get());
  lo_arg** values = lo_message_get_argv(message.get());
  for (int i = 0; i < lo_message_get_argc(message.get()); ++i) {
    if (types[i] == LO_INT32) {
      read.arguments.emplace_back(values[i]->i);
    } else if (types[i] == LO_FLOAT) {
      read.arguments.emplace_back(values[i]->f);
    } else if (types[i] == LO_STRING) {
      read.arguments.emplace_back(std::string(&values[i]->s));
    }
  }
  take(read);
  return absl::OkStatus();
}

absl::Status ReadElement(absl::string_view packet, int depth,
                         absl::FunctionRef<void(const OscMessage&)> take) {
  if (!absl::StartsWith(packet, kBundle)) return ReadMessage(packet, take);
  if (depth == kMaxDepth) return Malformed("bundles too deep");
  if (packet.size() < kHeadBytes) return Malformed("a bundle without a time");
  packet.remove_prefix(kHeadBytes);
  while (!packet.empty()) {
    if (packet.size() < 4) return Malformed("a bundle that is cut off");
    const uint32_t size = BigEndian(packet.data());
    packet.remove_prefix(4);
    if (size == 0 || size > packet.size()) {
      return Malformed(absl::StrCat("an element of ", size, " bytes where ",
                                    packet.size(), " are left"));
    }
    absl::Status status = ReadElement(packet.substr(0, size), depth + 1, take);
    if (!status.ok()) return status;
    packet.remove_prefix(size);
  }
  return absl::OkStatus();
}

void Add(const OscArgument& argument, lo_message message) {
  if (const int* number = std::get_if<int>(&argument)) {
    lo_message_add_int32(message, *number);
  } else if (const float* value = std::get_if<float>(&argument)) {
    lo_message_add_float(message, *value);
  } else {
    lo_message_add_string(message, std::get<std::string>(argument).c_str());
  }
}

}  // namespace

absl::Status ReadOscPacket(absl::string_view packet,
                           absl::FunctionRef<void(const OscMessage&)> take) {
  if (packet.size() > kMaxOscPacketBytes) return Malformed("a packet too long");
  return ReadElement(packet, 0, take);
}

std::string WriteOscBundle(const std::vector<OscMessage>& messages) {
  lo_bundle bundle = lo_bundle_new(LO_TT_IMMEDIATE);
  for (const OscMessage& message : messages) {
    lo_message made = lo_message_new();
    for (const OscArgument& argument : message.arguments) Add(argument, made);
    lo_bundle_add_message(bundle, message.path.c_str(), made);
  }
  std::string bytes(lo_bundle_length(bundle), '\0');
  lo_bundle_serialise(bundle, bytes.data(), nullptr);
  lo_bundle_free_recursive(bundle);
  return bytes;
}

}  // namespace gelenk::cli
