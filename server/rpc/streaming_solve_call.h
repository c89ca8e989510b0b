// SessionService.StreamingSolve: frames in, frames out.
//
// One stream, owned by one I/O thread: at most one read and one write are under
// way. A message's frames are solved in order; answers that are ready leave in
// one message. With too many unsent answers the stream stops reading, and
// HTTP/2 flow control holds the sender. Solves that may take long are done on a
// worker while the stream stands still.
#ifndef GELENK_SERVER_RPC_STREAMING_SOLVE_CALL_H_
#define GELENK_SERVER_RPC_STREAMING_SOLVE_CALL_H_

#include <google/protobuf/arena.h>
#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <map>
#include <memory>
#include <vector>

#include "absl/time/time.h"
#include "gelenk/v1/session_service.grpc.pb.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/message_arena.h"
#include "server/rpc/restartable_alarm.h"
#include "server/rpc/service_state.h"
#include "server/rpc/stream_slot.h"

namespace gelenk::server {

class StreamingSolveCall final : public Ticking {
 public:
  // Takes the next stream on `thread`, and the ones after it.
  static void Start(v1::SessionService::AsyncService* service,
                    ServiceState* state, IoThread* thread);

  void Tick(absl::Time now) override;

 private:
  // Answers leave in messages of at most about this many bytes: well below the
  // 4 MB that a client takes by default.
  static constexpr size_t kMaxAnswerBytes = 1 << 20;
  // A stream that solves longer than this gives way to the others.
  static constexpr absl::Duration kBurst = absl::Milliseconds(2);

  StreamingSolveCall(v1::SessionService::AsyncService* service,
                     ServiceState* state, IoThread* thread);
  ~StreamingSolveCall() override;

  void OnStarted(bool ok);
  void OnRead(bool ok);
  void OnWritten(bool ok);
  void OnWorked(bool ok);
  void OnFillTime(bool ok);
  void OnFinished(bool ok);

  // Begins with the message that was read.
  void TakeMessage();
  // Goes on with whatever can be gone on with.
  void Advance();
  // Works through the message that was read, as far as answers may pile up.
  // False when a heavy solve comes up and `heavy_allowed` is not.
  bool Consume(IkSolver& solver, bool heavy_allowed);
  bool ConsumeFrame(const v1::TargetFrame& frame, IkSolver& solver,
                    bool heavy_allowed);
  // Solves what LATEST_WINS slots have merged, as far as a message holds it.
  // False as in Consume.
  bool AnswerMerged(IkSolver& solver, bool heavy_allowed);
  // The same for one slot that is about to go.
  bool AnswerLast(int slot, IkSolver& solver, bool heavy_allowed);
  // Whether nothing that was sent waits: then slots may be filled.
  bool IsListening() const;
  // Answers for frames that did not come, where it is time. False as in
  // Consume.
  bool FillSlots(IkSolver& solver, bool heavy_allowed);
  void FillSlot(int slot, StreamSlot& stream_slot, IkSolver& solver,
                absl::Time now);
  // Wakes the stream when the next slot is to be filled.
  void SetFillAlarm();
  // Puts what was filled into the message, of one slot or as far as there is
  // room.
  void FlushFill(int slot);
  void FlushFills();
  void ConsumeOnWorker();

  void Attach(const v1::AttachSession& request);
  void Detach(int slot, const absl::Status& why);
  void AnswerSlot(int slot, StreamSlot& stream_slot, IkSolver& solver);
  v1::StreamEvent* AddEvent(v1::StreamEvent::Kind kind, int slot);
  v1::PoseFrame* AddAnswer(size_t bytes);

  bool IsFull() const;
  void CheckSlots();
  void StartRead();
  void StartWrite();
  void Close(const absl::Status& why);
  void Finish();
  void DeleteIfDone();

  v1::SessionService::AsyncService* const service_;
  ServiceState* const state_;
  IoThread* const thread_;
  CallCount count_;
  grpc::ServerContext context_;
  grpc::ServerAsyncReaderWriter<v1::StreamingSolveResponse,
                                v1::StreamingSolveRequest>
      stream_{&context_};
  Operation<StreamingSolveCall> started_{this, &StreamingSolveCall::OnStarted};
  Operation<StreamingSolveCall> read_{this, &StreamingSolveCall::OnRead};
  Operation<StreamingSolveCall> written_{this, &StreamingSolveCall::OnWritten};
  Operation<StreamingSolveCall> worked_{this, &StreamingSolveCall::OnWorked};
  Operation<StreamingSolveCall> fill_time_{this,
                                           &StreamingSolveCall::OnFillTime};
  Operation<StreamingSolveCall> finished_{this,
                                          &StreamingSolveCall::OnFinished};
  grpc::Alarm alarm_;
  RestartableAlarm fill_alarm_;
  std::unique_ptr<LimitedPlace> place_;

  std::map<int, std::unique_ptr<StreamSlot>> slots_;
  MessageArena<v1::StreamingSolveRequest> request_;
  // One is filled while the other is on its way.
  MessageArena<v1::StreamingSolveResponse> responses_[2];
  int filling_ = 0;
  size_t filled_bytes_ = 0;
  // The newest fill of each slot that has not left: a slow reader misses those
  // before it.
  std::map<int, v1::PoseFrame> unsent_fills_;

  // Where Consume stands in request_.
  bool has_message_ = false;
  int next_attach_ = 0;
  int next_frame_ = 0;
  int next_detach_ = 0;
  // A message came while a worker was at the slots.
  bool message_waits_ = false;
  // Slot that AnswerMerged answered last.
  int last_merged_ = -1;
  // The same for FillSlots.
  int last_filled_ = -1;
  absl::Time read_time_;
  absl::Time burst_begin_;

  bool ticking_ = false;
  bool reading_ = false;
  bool writing_ = false;
  bool working_ = false;
  // Some slot was attached that wants it.
  bool fills_ = false;
  bool fills_are_due_ = false;
  bool finishing_ = false;
  bool finished_call_ = false;
  bool half_closed_ = false;
  bool broken_ = false;
  bool said_draining_ = false;
  bool closing_ = false;
  absl::Time closing_since_;
  absl::Status close_status_;
  absl::Time last_write_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_STREAMING_SOLVE_CALL_H_
