// Ends the calls of another thread.
#ifndef GELENK_CLIENT_CANCELLATION_H_
#define GELENK_CLIENT_CANCELLATION_H_

#include <grpcpp/client_context.h>

#include <mutex>
#include <set>

namespace gelenk::client {

// Thread-safe. Once cancelled it stays so: later calls end at once.
class Cancellation {
 public:
  // While it lives, Cancel() reaches the call of `context`. A null
  // `cancellation` watches nothing.
  class Watch {
   public:
    Watch(Cancellation* cancellation, grpc::ClientContext& context);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

   private:
    Cancellation* const cancellation_;
    grpc::ClientContext& context_;
  };

  void Cancel();

 private:
  std::mutex mutex_;
  bool cancelled_ = false;
  std::set<grpc::ClientContext*> contexts_;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_CANCELLATION_H_
