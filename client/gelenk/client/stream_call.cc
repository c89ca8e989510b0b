#include "gelenk/client/stream_call.h"

#include "gelenk/client/status.h"
#include "gelenk/client/thread_order.h"

namespace gelenk::client {

void StreamCall::Start(const std::string& affinity_key,
                       Connection& connection) {
  SetAffinity(affinity_key, context_);
  connection.sessions().async()->StreamingSolve(&context_, this);
  open_ = true;
  // Writes start outside of reactions; the hold keeps OnDone away until reading
  // has ended, and no write starts after that.
  AddHold();
  ThreadOrderBefore(this);
  StartRead(&response_);
  StartCall();
}

void StreamCall::Write() {
  writing_ = true;
  ThreadOrderBefore(this);
  StartWrite(&request_);
}

void StreamCall::HalfClose() {
  half_closed_ = true;
  ThreadOrderBefore(this);
  StartWritesDone();
}

void StreamCall::OnReadDone(bool ok) {
  ThreadOrderAfter(this);
  {
    std::lock_guard<std::mutex> lock(*mutex_);
    if (ok) {
      owner_->OnResponse(&response_);
      ThreadOrderBefore(this);
      StartRead(&response_);
      return;
    }
    open_ = false;
    ThreadOrderBefore(this);
  }
  RemoveHold();
}

void StreamCall::OnWriteDone(bool ok) {
  ThreadOrderAfter(this);
  std::lock_guard<std::mutex> lock(*mutex_);
  writing_ = false;
  request_.Clear();
  // A failed write is followed by the end, which says why.
  if (ok) owner_->OnWritten();
}

void StreamCall::OnDone(const grpc::Status& status) {
  ThreadOrderAfter(this);
  std::lock_guard<std::mutex> lock(*mutex_);
  owner_->OnEnd(FromGrpc(status));
}

}  // namespace gelenk::client
