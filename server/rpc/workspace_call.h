// KinematicsService.ComputeWorkspace: computed on a worker, then written part
// by part.
#ifndef GELENK_SERVER_RPC_WORKSPACE_CALL_H_
#define GELENK_SERVER_RPC_WORKSPACE_CALL_H_

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <vector>

#include "absl/status/status.h"
#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

class WorkspaceCall {
 public:
  // Takes the next call on `thread`, and the ones after it.
  static void Start(v1::KinematicsService::AsyncService* service,
                    ServiceState* state, IoThread* thread);

 private:
  WorkspaceCall(v1::KinematicsService::AsyncService* service,
                ServiceState* state, IoThread* thread);

  void OnStarted(bool ok);
  void OnComputed(bool ok);
  void OnWritten(bool ok);
  void OnFinished(bool ok);

  // Fills parts_. On a worker.
  absl::Status Compute();
  void WriteNext();

  v1::KinematicsService::AsyncService* const service_;
  ServiceState* const state_;
  IoThread* const thread_;
  CallCount count_;
  grpc::ServerContext context_;
  v1::ComputeWorkspaceRequest request_;
  grpc::ServerAsyncWriter<v1::ComputeWorkspaceResponse> writer_{&context_};
  Operation<WorkspaceCall> started_{this, &WorkspaceCall::OnStarted};
  Operation<WorkspaceCall> computed_{this, &WorkspaceCall::OnComputed};
  Operation<WorkspaceCall> written_{this, &WorkspaceCall::OnWritten};
  Operation<WorkspaceCall> finished_{this, &WorkspaceCall::OnFinished};
  grpc::Alarm alarm_;

  absl::Status status_;
  std::vector<v1::ComputeWorkspaceResponse> parts_;
  size_t next_ = 0;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_WORKSPACE_CALL_H_
