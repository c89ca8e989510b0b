// KinematicsService.ImportSkeleton: a file comes in pieces, a skeleton is
// stored. The file is read on a worker; its bytes are bounded while they come.
#ifndef GELENK_SERVER_RPC_IMPORT_SKELETON_CALL_H_
#define GELENK_SERVER_RPC_IMPORT_SKELETON_CALL_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

class ImportSkeletonCall {
 public:
  // Takes the next import on `thread`, and the ones after it.
  static void Start(v1::KinematicsService::AsyncService* service,
                    ServiceState* state, IoThread* thread);

 private:
  ImportSkeletonCall(v1::KinematicsService::AsyncService* service,
                     ServiceState* state, IoThread* thread);

  void OnStarted(bool ok);
  void OnRead(bool ok);
  void OnFinished(bool ok);

  // Takes one piece.
  absl::Status Take();
  absl::Status Import();
  void Finish(const absl::Status& status);

  v1::KinematicsService::AsyncService* const service_;
  ServiceState* const state_;
  IoThread* const thread_;
  CallCount count_;
  grpc::ServerContext context_;
  v1::ImportSkeletonRequest request_;
  v1::ImportSkeletonResponse response_;
  grpc::ServerAsyncReader<v1::ImportSkeletonResponse, v1::ImportSkeletonRequest>
      reader_{&context_};
  Operation<ImportSkeletonCall> started_{this, &ImportSkeletonCall::OnStarted};
  Operation<ImportSkeletonCall> read_{this, &ImportSkeletonCall::OnRead};
  Operation<ImportSkeletonCall> finished_{this,
                                          &ImportSkeletonCall::OnFinished};
  std::unique_ptr<LimitedPlace> place_;
  bool has_header_ = false;
  v1::ImportHeader header_;
  std::string data_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_IMPORT_SKELETON_CALL_H_
