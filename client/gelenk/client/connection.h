// A connection to gelenkd: channel, stubs, deadlines and the affinity header.
//
//   gelenk::client::Connection connection("localhost:50051");
//   v1::GetSkeletonRequest request;
//   request.set_name("skeletons/arm");
//   absl::StatusOr<v1::Skeleton> skeleton = connection.Call(
//       &v1::KinematicsService::Stub::GetSkeleton, request);
//
// Errors are those of the server, or UNAVAILABLE (no server) and
// DEADLINE_EXCEEDED. Thread-safe; one connection serves any number of streams.
#ifndef GELENK_CLIENT_CONNECTION_H_
#define GELENK_CLIENT_CONNECTION_H_

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/security/credentials.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <typeindex>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/client/cancellation.h"
#include "gelenk/client/status.h"
#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "gelenk/v1/motion_service.grpc.pb.h"
#include "gelenk/v1/session_service.grpc.pb.h"

namespace gelenk::client {

struct ConnectionOptions {
  // Null means plain text.
  std::shared_ptr<grpc::ChannelCredentials> credentials;
  // Of every unary call.
  absl::Duration call_timeout = absl::Seconds(10);
  // Largest message taken in.
  int max_message_bytes = 64 << 20;
};

struct CallOptions {
  // Travels as metadata `gelenk-session`; every call that names a session needs
  // it. By default of the server, the session's id.
  std::string affinity_key;
  // Zero means that of the connection.
  absl::Duration timeout;
  // Ends the call from another thread, when not null.
  Cancellation* cancellation = nullptr;
};

class Connection {
 public:
  // `target` as gRPC takes it: "host:port", "unix:/path", "dns:///name:port".
  // Connects at the first call.
  explicit Connection(const std::string& target,
                      ConnectionOptions options = {});

  // DEADLINE_EXCEEDED when there is no connection after `timeout`.
  absl::Status WaitForReady(absl::Duration timeout);

  // The stub of a service, made at its first use: of one that is not named
  // here, stub<v1::SkinService::Stub>().
  template <class Stub>
  Stub& stub();
  v1::KinematicsService::Stub& kinematics() {
    return stub<v1::KinematicsService::Stub>();
  }
  v1::SessionService::Stub& sessions() {
    return stub<v1::SessionService::Stub>();
  }
  v1::MotionService::Stub& motion() { return stub<v1::MotionService::Stub>(); }

  // One unary call of any service, given as a pointer to the stub's method.
  template <class Stub, class Request, class Response>
  absl::StatusOr<Response> Call(
      grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                   Response*),
      const Request& request, const CallOptions& options = {});

  // Deadline and metadata of a unary call, for those who need the context.
  void Prepare(const CallOptions& options, grpc::ClientContext& context) const;

 private:
  const ConnectionOptions options_;
  const std::shared_ptr<grpc::Channel> channel_;
  std::mutex mutex_;
  // By the stub's type.
  std::map<std::type_index, std::shared_ptr<void>> stubs_
      ABSL_GUARDED_BY(mutex_);
};

// Sets the metadata that keeps a session on its server; an empty key sets none.
void SetAffinity(const std::string& affinity_key, grpc::ClientContext& context);

template <class Stub>
Stub& Connection::stub() {
  std::lock_guard<std::mutex> lock(mutex_);
  std::shared_ptr<void>& stub = stubs_[std::type_index(typeid(Stub))];
  if (stub == nullptr) stub = std::make_shared<Stub>(channel_);
  return *static_cast<Stub*>(stub.get());
}

template <class Stub, class Request, class Response>
absl::StatusOr<Response> Connection::Call(
    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                 Response*),
    const Request& request, const CallOptions& options) {
  grpc::ClientContext context;
  Prepare(options, context);
  const Cancellation::Watch watch(options.cancellation, context);
  Response response;
  const grpc::Status status =
      (stub<Stub>().*method)(&context, request, &response);
  if (!status.ok()) return FromGrpc(status);
  return response;
}

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_CONNECTION_H_
