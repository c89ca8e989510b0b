// A server stream on a completion queue: one request comes in, messages go out
// one by one, each made on a worker when the one before has left.
//
// What the messages are is the business of a Production. One that wants its
// next message later says when; a reader that takes none for `write_stall` is
// cut off.
#ifndef GELENK_SERVER_RPC_PRODUCTION_CALL_H_
#define GELENK_SERVER_RPC_PRODUCTION_CALL_H_

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"
#include "server/rpc/status.h"

namespace gelenk::server {

// What one call sends. On a worker, one call after the other.
template <class Response>
class Production {
 public:
  virtual ~Production() = default;
  // Fills the next message, which is empty; false when there is none.
  virtual absl::StatusOr<bool> Next(IkSolver& solver, Response* response) = 0;
  // When the next message is to be made.
  virtual absl::Time due() const { return absl::InfinitePast(); }
};

template <class Request, class Response>
class ProductionCall final : public Ticking {
 public:
  using Writer = grpc::ServerAsyncWriter<Response>;
  // Checks the request and begins. On a worker.
  using Open =
      std::function<absl::StatusOr<std::unique_ptr<Production<Response>>>(
          const Request&)>;

  struct Method {
    // A generated Request... function, bound to its service.
    std::function<void(grpc::ServerContext*, Request*, Writer*,
                       grpc::ServerCompletionQueue*, void*)>
        accept;
    Open open;
    ServiceState* state;
    IoThread* thread;
  };

  // Takes the next call of `method`, and the ones after it.
  static void Start(const Method& method) { new ProductionCall(method); }

  void Tick(absl::Time now) override {
    if (!writing_) return;
    if (now - write_begin_ < state().options.limits.write_stall) return;
    // A status would not get there either.
    writing_ = false;
    context_.TryCancel();
  }

 private:
  explicit ProductionCall(const Method& method)
      : method_(method), count_(*method.thread) {
    context_.AsyncNotifyWhenDone(done_.tag());
    method_.accept(&context_, &request_, &writer_, method_.thread->queue(),
                   started_.tag());
  }

  ~ProductionCall() override {
    if (ticking_) method_.thread->RemoveTicking(this);
  }

  ServiceState& state() const { return *method_.state; }

  void OnStarted(bool ok) {
    if (!ok) {  // the server is shutting down; `done_` never comes
      delete this;
      return;
    }
    Start(method_);
    place_ = std::make_unique<LimitedPlace>(state().streams,
                                            state().options.limits.max_streams);
    if (!place_->granted()) {
      Finish(absl::ResourceExhaustedError("too many streams are open"));
      return;
    }
    method_.thread->AddTicking(this);
    ticking_ = true;
    Produce();
  }

  // Makes the next message on a worker; OnProduced sends it.
  void Produce() {
    if (is_done_) return Finish(absl::CancelledError("the client is gone"));
    if (state().closing) {
      return Finish(absl::UnavailableError("the server's drain time is over"));
    }
    const bool taken = state().workers.Submit([this](IkSolver& solver) {
      produced_ = MakeNext(solver);
      PostTo(produced_op_, absl::InfinitePast());
    });
    if (!taken) {
      Finish(absl::ResourceExhaustedError("too many calls are waiting"));
    }
  }

  absl::StatusOr<bool> MakeNext(IkSolver& solver) {
    if (production_ == nullptr) {
      absl::StatusOr<std::unique_ptr<Production<Response>>> opened =
          method_.open(request_);
      if (!opened.ok()) return opened.status();
      production_ = *std::move(opened);
    }
    response_.Clear();
    return production_->Next(solver, &response_);
  }

  void OnProduced(bool) {
    if (!produced_.ok()) return Finish(produced_.status());
    if (!*produced_) return Finish(absl::OkStatus());
    write_begin_ = absl::Now();
    writing_ = true;
    writer_.Write(response_, written_.tag());
  }

  void OnWritten(bool ok) {
    writing_ = false;
    if (!ok) return Finish(absl::CancelledError("the client is gone"));
    if (production_->due() <= absl::Now()) return Produce();
    waiting_ = true;
    PostTo(due_, production_->due());
    if (is_done_) alarm_.Cancel();
  }

  void OnDue(bool) {
    waiting_ = false;
    Produce();
  }

  // Runs `operation` on the I/O thread at `time`.
  void PostTo(Operation<ProductionCall>& operation, absl::Time time) {
    alarm_.Set(method_.thread->queue(),
               absl::ToChronoTime(std::max(time, absl::UnixEpoch())),
               operation.tag());
  }

  void Finish(const absl::Status& status) {
    writer_.Finish(ToGrpc(status), finished_.tag());
  }

  void OnDone(bool) {
    is_done_ = true;
    if (waiting_) alarm_.Cancel();
    DeleteIfDone();
  }

  void OnFinished(bool) {
    finished_call_ = true;
    DeleteIfDone();
  }

  void DeleteIfDone() {
    if (finished_call_ && is_done_) delete this;
  }

  const Method method_;
  CallCount count_;
  grpc::ServerContext context_;
  Request request_;
  Response response_;
  Writer writer_{&context_};
  Operation<ProductionCall> started_{this, &ProductionCall::OnStarted};
  Operation<ProductionCall> produced_op_{this, &ProductionCall::OnProduced};
  Operation<ProductionCall> written_{this, &ProductionCall::OnWritten};
  Operation<ProductionCall> due_{this, &ProductionCall::OnDue};
  Operation<ProductionCall> done_{this, &ProductionCall::OnDone};
  Operation<ProductionCall> finished_{this, &ProductionCall::OnFinished};
  grpc::Alarm alarm_;
  std::unique_ptr<LimitedPlace> place_;
  std::unique_ptr<Production<Response>> production_;
  absl::StatusOr<bool> produced_ = false;

  absl::Time write_begin_;
  bool ticking_ = false;
  bool writing_ = false;
  bool waiting_ = false;  // for the next message to be due
  bool finished_call_ = false;
  bool is_done_ = false;  // the call is over for the transport
};

// Serves the method that `accept`, a generated Request... function, stands for.
template <class Service, class Base, class Request, class Response>
void ServeProduction(Service* service,
                     void (Base::*accept)(grpc::ServerContext*, Request*,
                                          grpc::ServerAsyncWriter<Response>*,
                                          grpc::CompletionQueue*,
                                          grpc::ServerCompletionQueue*, void*),
                     typename ProductionCall<Request, Response>::Open open,
                     ServiceState* state, IoThread* thread) {
  ProductionCall<Request, Response>::Start(
      {[service, accept](auto* context, auto* request, auto* writer,
                         auto* queue, void* tag) {
         (service->*accept)(context, request, writer, queue, queue, tag);
       },
       std::move(open), state, thread});
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_PRODUCTION_CALL_H_
