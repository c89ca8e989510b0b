// Waits for SIGTERM or SIGINT.
#ifndef GELENK_SERVER_OPS_STOP_SIGNAL_H_
#define GELENK_SERVER_OPS_STOP_SIGNAL_H_

#include <pthread.h>
#include <signal.h>

namespace gelenk::server {

// Blocks the signals for this thread and all that it starts from here on. A
// client that hangs up must not end the server either, so SIGPIPE is ignored.
class StopSignal {
 public:
  StopSignal() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGTERM);
    sigaddset(&signals_, SIGINT);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    signal(SIGPIPE, SIG_IGN);
  }

  int Wait() const {
    int number = 0;
    sigwait(&signals_, &number);
    return number;
  }

 private:
  sigset_t signals_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_OPS_STOP_SIGNAL_H_
