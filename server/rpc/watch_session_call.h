// SessionService.WatchSession: follows the poses of a session that somebody
// else drives. Latest wins; the driver never waits.
#ifndef GELENK_SERVER_RPC_WATCH_SESSION_CALL_H_
#define GELENK_SERVER_RPC_WATCH_SESSION_CALL_H_

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <memory>

#include "absl/time/time.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/v1/session_service.grpc.pb.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

class WatchSessionCall {
 public:
  // Takes the next viewer on `thread`, and the ones after it.
  static void Start(v1::SessionService::AsyncService* service,
                    ServiceState* state, IoThread* thread);

 private:
  WatchSessionCall(v1::SessionService::AsyncService* service,
                   ServiceState* state, IoThread* thread);

  void OnStarted(bool ok);
  void OnAlarm(bool ok);
  void OnWritten(bool ok);
  void OnCancelled(bool ok);
  void OnFinished(bool ok);

  // INVALID_ARGUMENT, NOT_FOUND, RESOURCE_EXHAUSTED.
  absl::Status Open();
  void Look();
  void Write();
  void Finish(const absl::Status& status);
  void DeleteIfDone();

  v1::SessionService::AsyncService* const service_;
  ServiceState* const state_;
  IoThread* const thread_;
  CallCount count_;
  grpc::ServerContext context_;
  v1::WatchSessionRequest request_;
  v1::WatchSessionResponse response_;
  grpc::ServerAsyncWriter<v1::WatchSessionResponse> writer_{&context_};
  Operation<WatchSessionCall> started_{this, &WatchSessionCall::OnStarted};
  Operation<WatchSessionCall> alarmed_{this, &WatchSessionCall::OnAlarm};
  Operation<WatchSessionCall> written_{this, &WatchSessionCall::OnWritten};
  Operation<WatchSessionCall> cancelled_{this, &WatchSessionCall::OnCancelled};
  Operation<WatchSessionCall> finished_{this, &WatchSessionCall::OnFinished};
  grpc::Alarm alarm_;
  std::unique_ptr<LimitedPlace> place_;

  std::shared_ptr<Session> session_;
  absl::Duration interval_;
  absl::Time last_write_;
  // What the viewer has seen; none at first, so that it gets the pose at once.
  uint64_t version_ = ~uint64_t{0};
  Eigen::VectorXd positions_;
  WorldTransforms frames_;

  bool alarm_set_ = false;
  bool finishing_ = false;
  bool finished_call_ = false;
  bool done_ = false;  // the call is over for the transport
  bool said_draining_ = false;
  bool said_ended_ = false;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_WATCH_SESSION_CALL_H_
