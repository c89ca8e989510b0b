#include "gelenk/client/connection.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/support/channel_arguments.h>

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"

namespace gelenk::client {
namespace {

// gRPC waits up to two minutes between its own attempts to connect; here the
// stream decides when to try again, and gRPC shall never be the slower one.
constexpr int kFirstReconnectMs = 20;
constexpr int kMaxReconnectMs = 500;
// An attempt may take this long; the name is gRPC's.
constexpr int kConnectTimeoutMs = 5000;

grpc::ChannelArguments ChannelArguments(const ConnectionOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(options.max_message_bytes);
  arguments.SetMaxSendMessageSize(options.max_message_bytes);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kFirstReconnectMs);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectTimeoutMs);
  // Two Connections are two connections.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return arguments;
}

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& target,
                                           const ConnectionOptions& options) {
  return grpc::CreateCustomChannel(target,
                                   options.credentials != nullptr
                                       ? options.credentials
                                       : grpc::InsecureChannelCredentials(),
                                   ChannelArguments(options));
}

}  // namespace

Connection::Connection(const std::string& target, ConnectionOptions options)
    : options_(std::move(options)), channel_(MakeChannel(target, options_)) {}

absl::Status Connection::WaitForReady(absl::Duration timeout) {
  const auto deadline =
      std::chrono::system_clock::now() + absl::ToChronoMicroseconds(timeout);
  if (channel_->WaitForConnected(deadline)) return absl::OkStatus();
  return absl::DeadlineExceededError(
      absl::StrCat("no connection after ", absl::FormatDuration(timeout)));
}

void Connection::Prepare(const CallOptions& options,
                         grpc::ClientContext& context) const {
  const absl::Duration timeout = options.timeout > absl::ZeroDuration()
                                     ? options.timeout
                                     : options_.call_timeout;
  context.set_deadline(std::chrono::system_clock::now() +
                       absl::ToChronoMicroseconds(timeout));
  SetAffinity(options.affinity_key, context);
}

void SetAffinity(const std::string& affinity_key,
                 grpc::ClientContext& context) {
  if (affinity_key.empty()) return;
  context.AddMetadata("gelenk-session", affinity_key);
}

}  // namespace gelenk::client
