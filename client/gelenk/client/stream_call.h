// One StreamingSolve call, from connect to status.
#ifndef GELENK_CLIENT_STREAM_CALL_H_
#define GELENK_CLIENT_STREAM_CALL_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "gelenk/client/connection.h"

namespace gelenk::client {

// Turns gRPC's reactions into three events under the owner's mutex, and keeps
// the rules of its calls: one write at a time, none after a half-close, none
// after the end. Functions, too, want the owner's mutex held. Lives until
// OnEnd.
class StreamCall : public grpc::ClientBidiReactor<v1::StreamingSolveRequest,
                                                  v1::StreamingSolveResponse> {
 public:
  class Owner {
   public:
    virtual ~Owner() = default;
    // `response` may be emptied.
    virtual void OnResponse(v1::StreamingSolveResponse* response) = 0;
    // CanWrite again.
    virtual void OnWritten() = 0;
    // The last one; the call may be destroyed when the mutex is free.
    virtual void OnEnd(absl::Status status) = 0;
  };

  StreamCall(std::mutex* mutex, Owner* owner) : mutex_(mutex), owner_(owner) {}

  void Start(const std::string& affinity_key, Connection& connection);

  bool CanWrite() const { return open_ && !writing_ && !half_closed_; }
  // What Write sends; empty whenever CanWrite.
  v1::StreamingSolveRequest* request() { return &request_; }
  void Write();
  void HalfClose();
  bool half_closed() const { return half_closed_; }
  void Cancel() { context_.TryCancel(); }

 private:
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  std::mutex* const mutex_;
  Owner* const owner_;
  grpc::ClientContext context_;
  v1::StreamingSolveRequest request_;
  v1::StreamingSolveResponse response_;
  bool open_ = false;
  bool writing_ = false;
  bool half_closed_ = false;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_STREAM_CALL_H_
