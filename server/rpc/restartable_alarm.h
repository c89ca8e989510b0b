// An alarm of a call that may be wanted earlier than it was set for.
//
// Used on the thread of its queue only. The call must not go while is_set():
// each RingBy that sets it is followed by one completion, also when it is
// cancelled.
#ifndef GELENK_SERVER_RPC_RESTARTABLE_ALARM_H_
#define GELENK_SERVER_RPC_RESTARTABLE_ALARM_H_

#include <grpcpp/alarm.h>
#include <grpcpp/completion_queue.h>

#include "absl/time/time.h"
#include "server/rpc/completion.h"

namespace gelenk::server {

class RestartableAlarm {
 public:
  bool is_set() const { return is_set_; }

  // `completion` runs at `time`; or before, and then whoever still wants it
  // asks anew.
  void RingBy(absl::Time time, grpc::CompletionQueue* queue,
              Completion& completion) {
    if (is_set_) {
      if (time < rings_at_) Cancel();
      return;
    }
    is_set_ = true;
    rings_at_ = time;
    alarm_.Set(queue, absl::ToChronoTime(time), completion.tag());
  }

  // The completion comes at once, where there is one to come.
  void Cancel() {
    if (!is_set_) return;
    rings_at_ = absl::InfinitePast();
    alarm_.Cancel();
  }

  // The completion has come.
  void SetRung() { is_set_ = false; }

 private:
  grpc::Alarm alarm_;
  bool is_set_ = false;
  absl::Time rings_at_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_RPC_RESTARTABLE_ALARM_H_
