// KinematicsService.ImportSkeleton: a file comes in pieces, a skeleton is
// stored. The file is read on a worker; its bytes are bounded while they come,
// and so is the time between them. Of a call that is cancelled nothing is
// stored.
#ifndef GELENK_SERVER_RPC_IMPORT_SKELETON_CALL_H_
#define GELENK_SERVER_RPC_IMPORT_SKELETON_CALL_H_

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <atomic>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "gelenk/v1/kinematics_service.grpc.pb.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"

namespace gelenk::server {

class ImportSkeletonCall final : public Ticking {
 public:
  // Takes the next import on `thread`, and the ones after it.
  static void Start(v1::KinematicsService::AsyncService* service,
                    ServiceState* state, IoThread* thread);

  void Tick(absl::Time now) override;

 private:
  ImportSkeletonCall(v1::KinematicsService::AsyncService* service,
                     ServiceState* state, IoThread* thread);
  ~ImportSkeletonCall() override;

  void OnStarted(bool ok);
  void OnRead(bool ok);
  void OnSettled(bool ok);
  void OnDone(bool ok);
  void OnFinished(bool ok);

  void Read();
  // Takes one piece.
  absl::Status Take();
  absl::Status Import();
  void Finish(const absl::Status& status);
  void DeleteIfDone();

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
  Operation<ImportSkeletonCall> settled_{this, &ImportSkeletonCall::OnSettled};
  Operation<ImportSkeletonCall> done_{this, &ImportSkeletonCall::OnDone};
  Operation<ImportSkeletonCall> finished_{this,
                                          &ImportSkeletonCall::OnFinished};
  grpc::Alarm alarm_;
  std::unique_ptr<LimitedPlace> place_;
  bool has_header_ = false;
  v1::ImportHeader header_;
  std::string data_;

  absl::Time last_read_;
  bool ticking_ = false;
  bool reading_ = false;
  bool finishing_ = false;
  bool finished_call_ = false;
  bool is_done_ = false;  // the call is over for the transport
  // Read by the worker.
  std::atomic<bool> cancelled_{false};
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_IMPORT_SKELETON_CALL_H_
