// What travels through a completion queue: a tag that knows what to run.
#ifndef GELENK_SERVER_RPC_COMPLETION_H_
#define GELENK_SERVER_RPC_COMPLETION_H_

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace gelenk::server {

class Completion {
 public:
  virtual ~Completion() = default;

  // What an operation is begun with, on any thread. ThreadSanitizer does not
  // see into gRPC: it is told that what came before happens before the
  // completion.
  void* tag() {
#if defined(__SANITIZE_THREAD__)
    __tsan_release(this);
#endif
    return this;
  }

  // Runs what the queue gave back; `ok` is what it says of the operation.
  static void Arrive(void* tag, bool ok) {
#if defined(__SANITIZE_THREAD__)
    __tsan_acquire(tag);
#endif
    static_cast<Completion*>(tag)->Run(ok);
  }

 protected:
  virtual void Run(bool ok) = 0;
};

// Runs a member function of a call; lives inside the call.
template <class Call>
class Operation final : public Completion {
 public:
  Operation(Call* call, void (Call::*run)(bool)) : call_(call), run_(run) {}

 private:
  void Run(bool ok) override { (call_->*run_)(ok); }

  Call* const call_;
  void (Call::*const run_)(bool);
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_COMPLETION_H_
