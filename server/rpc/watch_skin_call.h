// SkinService.WatchSkin: follows the skin of a session that somebody drives.
// Latest wins, the driver never waits; what is skipped is skipped before it is
// encoded, so that differences stay whole. A frame is made on a worker; a new
// revision of the skin takes over with its layout and a keyframe.
#ifndef GELENK_SERVER_RPC_WATCH_SKIN_CALL_H_
#define GELENK_SERVER_RPC_WATCH_SKIN_CALL_H_

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "gelenk/v1/skin_service.grpc.pb.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"
#include "server/rpc/skin_frames.h"
#include "server/session/revision_name.h"

namespace gelenk::server {

class WatchSkinCall {
 public:
  // Takes the next viewer on `thread`, and the ones after it.
  static void Start(v1::SkinService::AsyncService* service, ServiceState* state,
                    IoThread* thread);

 private:
  // What is under way besides reading; one thing at a time.
  enum class Step { kNone, kWaiting, kMaking, kWriting };

  WatchSkinCall(v1::SkinService::AsyncService* service, ServiceState* state,
                IoThread* thread);

  void OnStarted(bool ok);
  void OnRead(bool ok);
  void OnAlarm(bool ok);
  void OnMade(bool ok);
  void OnWritten(bool ok);
  void OnCancelled(bool ok);
  void OnFinished(bool ok);

  void Read();
  // INVALID_ARGUMENT, NOT_FOUND, RESOURCE_EXHAUSTED.
  absl::Status Take(const v1::WatchSkinRequest& request);
  absl::Status Open(const v1::WatchSkinRequest::Start& start);
  // Goes over to `stored`.
  absl::Status Show(StoredSkin stored);

  // Does what is due.
  void Look();
  // Says that there is no more, and why.
  void WriteEnd(const absl::Status& why);
  void WriteEvent(v1::StreamEvent::Kind kind);
  // The layout, else the frame of positions_, on a worker.
  void Make();
  void Write();
  void WaitUntil(absl::Time time);
  // Ends the call when nothing is under way any more.
  void Leave(const absl::Status& status);
  void FinishIfFree();
  void DeleteIfDone();

  v1::SkinService::AsyncService* const service_;
  ServiceState* const state_;
  IoThread* const thread_;
  CallCount count_;
  grpc::ServerContext context_;
  v1::WatchSkinRequest request_;
  v1::WatchSkinResponse response_;
  grpc::ServerAsyncReaderWriter<v1::WatchSkinResponse, v1::WatchSkinRequest>
      stream_{&context_};
  Operation<WatchSkinCall> started_{this, &WatchSkinCall::OnStarted};
  Operation<WatchSkinCall> read_{this, &WatchSkinCall::OnRead};
  Operation<WatchSkinCall> alarmed_{this, &WatchSkinCall::OnAlarm};
  Operation<WatchSkinCall> made_{this, &WatchSkinCall::OnMade};
  Operation<WatchSkinCall> written_{this, &WatchSkinCall::OnWritten};
  Operation<WatchSkinCall> cancelled_{this, &WatchSkinCall::OnCancelled};
  Operation<WatchSkinCall> finished_{this, &WatchSkinCall::OnFinished};
  grpc::Alarm alarm_;
  std::unique_ptr<LimitedPlace> place_;

  std::shared_ptr<Session> session_;
  RevisionedName skin_name_;
  SkinFrameOptions frame_options_;
  std::unique_ptr<SkinFrames> frames_;
  absl::Duration interval_;
  absl::Time last_write_;
  // What the viewer has seen; none at first, so that it gets the pose at once.
  uint64_t version_ = 0;
  Eigen::VectorXd positions_;
  RigidTransform world_from_skeleton_;
  int64_t sequence_number_ = 0;
  bool layout_due_ = false;
  bool keyframe_due_ = false;

  Step step_ = Step::kNone;
  bool reading_ = false;
  bool said_draining_ = false;
  bool leaving_ = false;
  absl::Status leave_status_;
  bool finishing_ = false;
  bool finished_call_ = false;
  bool done_ = false;  // the call is over for the transport
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_WATCH_SKIN_CALL_H_
