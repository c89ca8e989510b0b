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

#include <memory>
#include <string>

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

  v1::KinematicsService::Stub& kinematics() { return *kinematics_; }
  v1::SessionService::Stub& sessions() { return *sessions_; }
  v1::MotionService::Stub& motion() { return *motion_; }

  // One unary call of any service, given as a pointer to the stub's method.
  template <class Stub, class Request, class Response>
  absl::StatusOr<Response> Call(
      grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                   Response*),
      const Request& request, const CallOptions& options = {});

  // Deadline and metadata of a unary call, for those who need the context.
  void Prepare(const CallOptions& options, grpc::ClientContext& context) const;

 private:
  v1::KinematicsService::Stub& StubOf(v1::KinematicsService::Stub*) {
    return *kinematics_;
  }
  v1::SessionService::Stub& StubOf(v1::SessionService::Stub*) {
    return *sessions_;
  }
  v1::MotionService::Stub& StubOf(v1::MotionService::Stub*) { return *motion_; }

  const ConnectionOptions options_;
  const std::shared_ptr<grpc::Channel> channel_;
  const std::unique_ptr<v1::KinematicsService::Stub> kinematics_;
  const std::unique_ptr<v1::SessionService::Stub> sessions_;
  const std::unique_ptr<v1::MotionService::Stub> motion_;
};

// Sets the metadata that keeps a session on its server; an empty key sets none.
void SetAffinity(const std::string& affinity_key, grpc::ClientContext& context);

template <class Stub, class Request, class Response>
absl::StatusOr<Response> Connection::Call(
    grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                 Response*),
    const Request& request, const CallOptions& options) {
  grpc::ClientContext context;
  Prepare(options, context);
  const Cancellation::Watch watch(options.cancellation, context);
  Stub& stub = StubOf(static_cast<Stub*>(nullptr));
  Response response;
  const grpc::Status status = (stub.*method)(&context, request, &response);
  if (!status.ok()) return FromGrpc(status);
  return response;
}

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_CONNECTION_H_
