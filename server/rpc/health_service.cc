#include "server/rpc/health_service.h"

#include <grpcpp/server_context.h>
#include <grpcpp/support/async_stream.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

namespace health = grpc::health::v1;
using Service = health::Health::AsyncService;

bool IsKnown(const std::string& service) {
  return service.empty() || service == "gelenk.v1.SessionService" ||
         service == "gelenk.v1.KinematicsService" ||
         service == "gelenk.v1.MotionService" ||
         service == "gelenk.v1.SkinService";
}

health::HealthCheckResponse::ServingStatus StatusNow(
    const ServiceState& state) {
  return state.draining ? health::HealthCheckResponse::NOT_SERVING
                        : health::HealthCheckResponse::SERVING;
}

absl::Status Check(const ServiceState& state,
                   const health::HealthCheckRequest& request,
                   health::HealthCheckResponse* response) {
  if (!IsKnown(request.service())) {
    return absl::NotFoundError(
        absl::StrCat("service: no \"", request.service(), "\" here"));
  }
  response->set_status(StatusNow(state));
  return absl::OkStatus();
}

// Says the state at once and at each change, until the caller leaves.
class WatchHealthCall final : public Ticking {
 public:
  static void Start(Service* service, ServiceState* state, IoThread* thread) {
    new WatchHealthCall(service, state, thread);
  }

  void Tick(absl::Time) override {
    const bool over = gone_ || state_->closing;
    if (writing_ || finishing_) return;
    if (over) {
      finishing_ = true;
      writer_.Finish(grpc::Status::CANCELLED, finished_.tag());
      return;
    }
    const auto status = IsKnown(request_.service())
                            ? StatusNow(*state_)
                            : health::HealthCheckResponse::SERVICE_UNKNOWN;
    if (said_anything_ && status == response_.status()) return;
    said_anything_ = true;
    response_.set_status(status);
    writing_ = true;
    writer_.Write(response_, written_.tag());
  }

 private:
  WatchHealthCall(Service* service, ServiceState* state, IoThread* thread)
      : service_(service), state_(state), thread_(thread), count_(*thread) {
    context_.AsyncNotifyWhenDone(cancelled_.tag());
    grpc::ServerCompletionQueue* queue = thread_->queue();
    service_->RequestWatch(&context_, &request_, &writer_, queue, queue,
                           started_.tag());
  }
  ~WatchHealthCall() override {
    if (ticking_) thread_->RemoveTicking(this);
  }

  void OnStarted(bool ok) {
    if (!ok) {  // the server is shutting down; `cancelled_` never comes
      delete this;
      return;
    }
    Start(service_, state_, thread_);
    thread_->AddTicking(this);
    ticking_ = true;
    Tick(absl::InfinitePast());
  }
  void OnWritten(bool ok) {
    writing_ = false;
    if (!ok) gone_ = true;
  }
  void OnCancelled(bool) {
    gone_ = true;
    told_ = true;
    DeleteIfDone();
  }
  void OnFinished(bool) {
    finished_call_ = true;
    DeleteIfDone();
  }
  void DeleteIfDone() {
    if (told_ && finished_call_) delete this;
  }

  Service* const service_;
  ServiceState* const state_;
  IoThread* const thread_;
  CallCount count_;
  grpc::ServerContext context_;
  health::HealthCheckRequest request_;
  health::HealthCheckResponse response_;
  grpc::ServerAsyncWriter<health::HealthCheckResponse> writer_{&context_};
  Operation<WatchHealthCall> started_{this, &WatchHealthCall::OnStarted};
  Operation<WatchHealthCall> written_{this, &WatchHealthCall::OnWritten};
  Operation<WatchHealthCall> cancelled_{this, &WatchHealthCall::OnCancelled};
  Operation<WatchHealthCall> finished_{this, &WatchHealthCall::OnFinished};
  bool ticking_ = false;
  bool said_anything_ = false;
  bool writing_ = false;
  bool finishing_ = false;
  bool gone_ = false;
  bool told_ = false;
  bool finished_call_ = false;
};

}  // namespace

void ServeHealth(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestCheck,
      [state](IkSolver&, const health::HealthCheckRequest& request,
              health::HealthCheckResponse* response) {
        return Check(*state, request, response);
      },
      state, thread);
  WatchHealthCall::Start(service, state, thread);
}

}  // namespace gelenk::server
