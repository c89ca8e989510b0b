// One unary method on a completion queue: accepted on the I/O thread, answered
// on a worker by a plain function.
#ifndef GELENK_SERVER_RPC_UNARY_CALL_H_
#define GELENK_SERVER_RPC_UNARY_CALL_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/async_unary_call.h>

#include <functional>
#include <utility>

#include "absl/status/status.h"
#include "server/rpc/completion.h"
#include "server/rpc/io_thread.h"
#include "server/rpc/service_state.h"
#include "server/rpc/status.h"

namespace gelenk::server {

template <class Request, class Response>
class UnaryCall {
 public:
  using Writer = grpc::ServerAsyncResponseWriter<Response>;
  // A generated Request… function, bound to its service.
  using Accept = std::function<void(grpc::ServerContext*, Request*, Writer*,
                                    grpc::ServerCompletionQueue*, void*)>;
  using Handle =
      std::function<absl::Status(IkSolver&, const Request&, Response*)>;

  struct Method {
    Accept accept;
    Handle handle;
    ServiceState* state;
    IoThread* thread;
  };

  // Takes the next call of `method`, and the ones after it.
  static void Start(const Method& method) { new UnaryCall(method); }

 private:
  explicit UnaryCall(const Method& method)
      : method_(method), count_(*method.thread) {
    method_.accept(&context_, &request_, &writer_, method_.thread->queue(),
                   started_.tag());
  }

  void OnStarted(bool ok) {
    if (!ok) {  // the server is shutting down
      delete this;
      return;
    }
    Start(method_);
    const bool taken = method_.state->workers.Submit([this](IkSolver& solver) {
      Finish(method_.handle(solver, request_, &response_));
    });
    if (!taken) {
      Finish(absl::ResourceExhaustedError("too many calls are waiting"));
    }
  }

  void Finish(const absl::Status& status) {
    if (status.ok()) {
      writer_.Finish(response_, grpc::Status::OK, finished_.tag());
    } else {
      writer_.FinishWithError(ToGrpc(status), finished_.tag());
    }
  }

  void OnFinished(bool) { delete this; }

  const Method method_;
  CallCount count_;
  grpc::ServerContext context_;
  Request request_;
  Response response_;
  grpc::ServerAsyncResponseWriter<Response> writer_{&context_};
  Operation<UnaryCall> started_{this, &UnaryCall::OnStarted};
  Operation<UnaryCall> finished_{this, &UnaryCall::OnFinished};
};

// Serves the method that `accept`, a generated Request… function, stands for.
template <class Service, class Base, class Request, class Response>
void ServeUnary(Service* service,
                void (Base::*accept)(grpc::ServerContext*, Request*,
                                     grpc::ServerAsyncResponseWriter<Response>*,
                                     grpc::CompletionQueue*,
                                     grpc::ServerCompletionQueue*, void*),
                typename UnaryCall<Request, Response>::Handle handle,
                ServiceState* state, IoThread* thread) {
  UnaryCall<Request, Response>::Start(
      {[service, accept](auto* context, auto* request, auto* writer,
                         auto* queue, void* tag) {
         (service->*accept)(context, request, writer, queue, queue, tag);
       },
       std::move(handle), state, thread});
}

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_UNARY_CALL_H_
