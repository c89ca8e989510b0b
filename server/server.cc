#include "server/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "server/rpc/health_service.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/kinematics_service.h"
#include "server/rpc/motion_service.h"
#include "server/rpc/service_state.h"
#include "server/rpc/session_service.h"
#include "server/rpc/skin_service.h"

namespace gelenk::server {
namespace {

// How often expired sessions are looked for.
constexpr absl::Duration kSweepInterval = absl::Seconds(1);
// After the drain time: for streams to read why they end.
constexpr absl::Duration kClosingGrace = absl::Seconds(2);

// What a client may send ahead on a stream that is not read: about 5 MB/s from
// another continent. gRPC would otherwise measure the line and let one stream
// fill up tens of MB.
constexpr int kStreamWindowBytes = 256 << 10;
// What clients may ping at most.
constexpr absl::Duration kLeastPingInterval = absl::Seconds(5);

ServerOptions WithDefaults(ServerOptions options) {
  const int cores =
      std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  if (options.io_threads == 0) options.io_threads = std::max(1, cores / 2);
  if (options.worker_threads == 0) options.worker_threads = cores;
  return options;
}

// Finds out clients that are gone without a word, and those that never had one.
void SetKeepalive(absl::Duration keepalive, grpc::ServerBuilder& builder) {
  const auto set = [&builder](const char* argument, absl::Duration value) {
    constexpr int64_t kMost = std::numeric_limits<int>::max();
    builder.AddChannelArgument(
        argument, static_cast<int>(std::clamp<int64_t>(
                      absl::ToInt64Milliseconds(value), 1, kMost)));
  };
  set(GRPC_ARG_KEEPALIVE_TIME_MS, keepalive);
  set(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, keepalive);
  set(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, keepalive);
  // Also without a call: idle connections are memory, too.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  // Games ping every ten seconds or so; gRPC hangs up on those who ping more
  // often than this, three times.
  set(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
      kLeastPingInterval);
}

// Ids need to be unguessable by accident only.
uint64_t Random64() {
  std::random_device device;
  return (uint64_t{device()} << 32) | device();
}

class GrpcServer final : public Server {
 public:
  explicit GrpcServer(ServerOptions options)
      : state_(WithDefaults(std::move(options)), Random64) {}

  ~GrpcServer() override { Drain(absl::ZeroDuration()); }

  absl::Status Listen() {
    // The platform's Abseil is built with checks for deadlocks, which take a
    // global lock for each of ours.
    absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
    const ServerOptions& options = state_.options;
    if (options.reflection) {
      grpc::reflection::InitProtoReflectionServerBuilderPlugin();
    }
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort(options.listen, grpc::InsecureServerCredentials(),
                             &port);
    // Else a second server on the port would start in silence, and the kernel
    // would split the sessions between the two.
    builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
    SetKeepalive(options.keepalive, builder);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
    builder.AddChannelArgument(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES,
                               kStreamWindowBytes);
    builder.SetMaxReceiveMessageSize(options.limits.max_message_bytes);
    builder.RegisterService(&kinematics_);
    builder.RegisterService(&sessions_);
    builder.RegisterService(&motion_);
    builder.RegisterService(&skins_);
    builder.RegisterService(&health_);
    for (int i = 0; i < options.io_threads; ++i) {
      threads_.push_back(std::make_unique<IoThread>(
          builder.AddCompletionQueue(), options.instruction_set));
    }
    server_ = builder.BuildAndStart();
    if (server_ == nullptr || port == 0) {
      return absl::UnavailableError(
          absl::StrCat("listen: cannot bind ", options.listen));
    }
    const bool has_port = !absl::StartsWith(options.listen, "unix:");
    address_ =
        has_port
            ? absl::StrCat(options.listen.substr(0, options.listen.rfind(':')),
                           ":", port)
            : options.listen;
    for (const std::unique_ptr<IoThread>& thread : threads_) {
      ServeKinematics(&kinematics_, &state_, thread.get());
      ServeSessions(&sessions_, &state_, thread.get());
      ServeMotion(&motion_, &state_, thread.get());
      ServeSkins(&skins_, &state_, thread.get());
      ServeHealth(&health_, &state_, thread.get());
      thread->Start();
    }
    sweeper_ = std::thread([this] {
      while (!stopped_.WaitForNotificationWithTimeout(kSweepInterval)) {
        state_.sessions.Sweep(absl::Now());
      }
    });
    return absl::OkStatus();
  }

  const std::string& address() const override { return address_; }
  int stream_count() const override { return state_.streams; }

  void Drain(absl::Duration grace) override {
    if (server_ == nullptr) return;
    state_.draining = true;
    const absl::Time deadline = absl::Now() + grace;
    while (state_.streams > 0 && absl::Now() < deadline) {
      absl::SleepFor(absl::Milliseconds(10));
    }
    state_.closing = true;
    const absl::Time end =
        absl::Now() + (state_.streams > 0 && grace > absl::ZeroDuration()
                           ? kClosingGrace
                           : absl::Milliseconds(100));
    server_->Shutdown(absl::ToChronoTime(end));
    for (const std::unique_ptr<IoThread>& thread : threads_) thread->Join();
    server_.reset();
    if (!stopped_.HasBeenNotified()) stopped_.Notify();
    if (sweeper_.joinable()) sweeper_.join();
  }

 private:
  ServiceState state_;
  v1::KinematicsService::AsyncService kinematics_;
  v1::SessionService::AsyncService sessions_;
  v1::MotionService::AsyncService motion_;
  v1::SkinService::AsyncService skins_;
  grpc::health::v1::Health::AsyncService health_;
  std::vector<std::unique_ptr<IoThread>> threads_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  absl::Notification stopped_;
  std::thread sweeper_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::Start(ServerOptions options) {
  if (absl::Status status = CheckOptions(options); !status.ok()) {
    return status;
  }
  auto server = std::make_unique<GrpcServer>(std::move(options));
  if (absl::Status status = server->Listen(); !status.ok()) return status;
  return server;
}

}  // namespace gelenk::server
