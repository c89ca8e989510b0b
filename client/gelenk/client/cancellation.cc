#include "gelenk/client/cancellation.h"

namespace gelenk::client {

Cancellation::Watch::Watch(Cancellation* cancellation,
                           grpc::ClientContext& context)
    : cancellation_(cancellation), context_(context) {
  if (cancellation_ == nullptr) return;
  std::lock_guard<std::mutex> lock(cancellation_->mutex_);
  cancellation_->contexts_.insert(&context_);
  if (cancellation_->cancelled_) context_.TryCancel();
}

Cancellation::Watch::~Watch() {
  if (cancellation_ == nullptr) return;
  std::lock_guard<std::mutex> lock(cancellation_->mutex_);
  cancellation_->contexts_.erase(&context_);
}

void Cancellation::Cancel() {
  std::lock_guard<std::mutex> lock(mutex_);
  cancelled_ = true;
  for (grpc::ClientContext* context : contexts_) context->TryCancel();
}

}  // namespace gelenk::client
