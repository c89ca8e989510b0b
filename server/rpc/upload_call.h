// A client stream on a completion queue: pieces come in, one answer goes out.
//
// What the pieces are is the business of an Upload. Pieces are taken on the I/O
// thread, what they make up is worked on by a worker. Uploads at a time are
// bounded, and so is the time between two pieces. Of a call that is cancelled
// nothing is kept.
#ifndef GELENK_SERVER_RPC_UPLOAD_CALL_H_
#define GELENK_SERVER_RPC_UPLOAD_CALL_H_

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"
#include "server/rpc/status.h"

namespace gelenk::server {

// What one call collects.
template <class Request, class Response>
class Upload {
 public:
  virtual ~Upload() = default;
  // The next piece, which it may take apart. On the I/O thread.
  virtual absl::Status Take(Request& piece) = 0;
  // After the last piece. On a worker. Keeps nothing where `is_cancelled` says
  // that nobody waits for it any more.
  virtual absl::Status Complete(const std::function<bool()>& is_cancelled,
                                Response* response) = 0;
};

inline absl::Status ClientIsGone() {
  return absl::CancelledError("the client is gone");
}

template <class Request, class Response>
class UploadCall final : public Ticking {
 public:
  using Reader = grpc::ServerAsyncReader<Response, Request>;
  using Open = std::function<std::unique_ptr<Upload<Request, Response>>()>;

  struct Method {
    // A generated Request... function, bound to its service.
    std::function<void(grpc::ServerContext*, Reader*,
                       grpc::ServerCompletionQueue*, void*)>
        accept;
    Open open;
    ServiceState* state;
    IoThread* thread;
  };

  // Takes the next call of `method`, and the ones after it.
  static void Start(const Method& method) { new UploadCall(method); }

  void Tick(absl::Time now) override {
    const absl::Duration stall = state().options.limits.import_stall;
    // While a worker is at the call, nothing is read.
    if (!reading_ || finishing_ || now - last_read_ < stall) return;
    Finish(absl::DeadlineExceededError(
        absl::StrCat("data: no piece came for ", absl::FormatDuration(stall))));
  }

 private:
  explicit UploadCall(const Method& method)
      : method_(method), count_(*method.thread) {
    context_.AsyncNotifyWhenDone(done_.tag());
    method_.accept(&context_, &reader_, method_.thread->queue(),
                   started_.tag());
  }

  ~UploadCall() override {
    if (ticking_) method_.thread->RemoveTicking(this);
  }

  ServiceState& state() const { return *method_.state; }

  void OnStarted(bool ok) {
    if (!ok) {  // the server is shutting down; `done_` never comes
      delete this;
      return;
    }
    Start(method_);
    place_ = std::make_unique<LimitedPlace>(state().imports,
                                            state().options.limits.max_imports);
    if (!place_->granted()) {
      Finish(absl::ResourceExhaustedError("too many imports are under way"));
      return;
    }
    upload_ = method_.open();
    method_.thread->AddTicking(this);
    ticking_ = true;
    Read();
  }

  void Read() {
    last_read_ = absl::Now();
    reading_ = true;
    reader_.Read(&request_, read_.tag());
  }

  void OnRead(bool ok) {
    reading_ = false;
    if (finishing_) {
      DeleteIfDone();
      return;
    }
    if (ok) {
      if (absl::Status status = upload_->Take(request_); !status.ok()) {
        Finish(status);
        return;
      }
      Read();
      return;
    }
    // The reads of a cancelled call end as if it was half-closed; OnDone, which
    // tells the difference, is right behind.
    alarm_.Set(method_.thread->queue(), std::chrono::system_clock::now(),
               settled_.tag());
  }

  void OnSettled(bool) {
    if (cancelled_) {
      Finish(ClientIsGone());
      return;
    }
    const bool taken = state().workers.Submit([this](IkSolver&) {
      Finish(
          upload_->Complete([this] { return cancelled_.load(); }, &response_));
    });
    if (!taken) {
      Finish(absl::ResourceExhaustedError("too many calls are waiting"));
    }
  }

  void Finish(const absl::Status& status) {
    finishing_ = true;
    if (status.ok()) {
      reader_.Finish(response_, grpc::Status::OK, finished_.tag());
    } else {
      reader_.FinishWithError(ToGrpc(status), finished_.tag());
    }
  }

  void OnDone(bool) {
    is_done_ = true;
    cancelled_ = context_.IsCancelled();
    DeleteIfDone();
  }

  void OnFinished(bool) {
    finished_call_ = true;
    DeleteIfDone();
  }

  void DeleteIfDone() {
    if (finished_call_ && is_done_ && !reading_) delete this;
  }

  const Method method_;
  CallCount count_;
  grpc::ServerContext context_;
  Request request_;
  Response response_;
  Reader reader_{&context_};
  Operation<UploadCall> started_{this, &UploadCall::OnStarted};
  Operation<UploadCall> read_{this, &UploadCall::OnRead};
  Operation<UploadCall> settled_{this, &UploadCall::OnSettled};
  Operation<UploadCall> done_{this, &UploadCall::OnDone};
  Operation<UploadCall> finished_{this, &UploadCall::OnFinished};
  grpc::Alarm alarm_;
  std::unique_ptr<LimitedPlace> place_;
  std::unique_ptr<Upload<Request, Response>> upload_;

  absl::Time last_read_;
  bool ticking_ = false;
  bool reading_ = false;
  bool finishing_ = false;
  bool finished_call_ = false;
  bool is_done_ = false;  // the call is over for the transport
  // Read by the worker.
  std::atomic<bool> cancelled_{false};
};

// Serves the method that `accept`, a generated Request... function, stands for.
template <class Service, class Base, class Request, class Response>
void ServeUpload(
    Service* service,
    void (Base::*accept)(grpc::ServerContext*,
                         grpc::ServerAsyncReader<Response, Request>*,
                         grpc::CompletionQueue*, grpc::ServerCompletionQueue*,
                         void*),
    typename UploadCall<Request, Response>::Open open, ServiceState* state,
    IoThread* thread) {
  UploadCall<Request, Response>::Start(
      {[service, accept](auto* context, auto* reader, auto* queue, void* tag) {
         (service->*accept)(context, reader, queue, queue, tag);
       },
       std::move(open), state, thread});
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_UPLOAD_CALL_H_
