// What travels through a completion queue: a tag that knows what to run.
#ifndef GELENK_SERVER_RPC_COMPLETION_H_
#define GELENK_SERVER_RPC_COMPLETION_H_

namespace gelenk::server {

class Completion {
 public:
  virtual ~Completion() = default;
  // `ok` is what the queue says of the operation.
  virtual void Run(bool ok) = 0;
};

// Runs a member function of a call; lives inside the call.
template <class Call>
class Operation final : public Completion {
 public:
  Operation(Call* call, void (Call::*run)(bool)) : call_(call), run_(run) {}
  void Run(bool ok) override { (call_->*run_)(ok); }

 private:
  Call* const call_;
  void (Call::*const run_)(bool);
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_COMPLETION_H_
