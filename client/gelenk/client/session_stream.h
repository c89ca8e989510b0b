// A stream of target frames in, poses out, that survives the loss of its
// connection and of its server.
//
//   std::vector<SessionSpec> specs(1);
//   *specs[0].skeleton.mutable_skeleton() = arm;
//   *specs[0].session.mutable_session()->add_goals() = reach;
//   specs[0].frame_policy = v1::FRAME_POLICY_EVERY_FRAME;
//   auto stream = SessionStream::Open(connection, {}, specs);
//   ...
//   (*stream)->SendNext(frame);
//   auto pose = (*stream)->Receive(absl::Seconds(1));
//   ...
//   (*stream)->Close(absl::Seconds(5));
//
// One stream drives one or more sessions; slot i is that of specs[i]. For each,
// the library keeps what created it, the last answer and the frames without
// answer. When the connection or the server is lost, it connects again (waits
// grow, with jitter), creates again what is gone, resumes from the last answer
// and sends the frames without answer again. With EVERY_FRAME the answers are
// bit for bit those of an undisturbed stream, on the same build and instruction
// set; with LATEST_WINS the newest state is solved and nothing older.
//
// Send, Receive and Close may be called from different threads at a time; each
// of them from one thread at a time.
#ifndef GELENK_CLIENT_SESSION_STREAM_H_
#define GELENK_CLIENT_SESSION_STREAM_H_

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/client/backoff.h"
#include "gelenk/client/cancellation.h"
#include "gelenk/client/connection.h"
#include "gelenk/client/session_spec.h"
#include "gelenk/client/slot_table.h"
#include "gelenk/client/stream_call.h"
#include "gelenk/client/stream_statistics.h"

namespace gelenk::client {

struct SessionStreamOptions {
  // Frames of one slot without answer: EVERY_FRAME holds the sender there,
  // LATEST_WINS merges there.
  int window = 64;
  // Frames that wait while a message is written go out together, up to so many.
  // None ever waits to be joined by others.
  int max_frames_per_message = 32;
  // Open gives up after this long.
  absl::Duration open_timeout = absl::Seconds(10);
  // A stream whose attempts fail for this long ends.
  absl::Duration give_up_after = absl::Seconds(60);
  // Silence for this long is a loss: a living server says something every 5 s.
  absl::Duration silence_timeout = absl::Seconds(15);
  // A stream that was half-closed is cut after this long.
  absl::Duration half_close_timeout = absl::Seconds(5);
  BackoffOptions backoff;
  // Of jitter and of chosen ids; unset takes one from the system.
  std::optional<uint64_t> seed;
};

class SessionStream final : private StreamCall::Owner {
 public:
  // Creates skeletons and sessions, attaches them, and waits until they are.
  // INVALID_ARGUMENT for specs that do not fit together; otherwise the first
  // error of the server, or of the connection after `open_timeout`.
  static absl::StatusOr<std::unique_ptr<SessionStream>> Open(
      std::shared_ptr<Connection> connection,
      const SessionStreamOptions& options, std::vector<SessionSpec> specs);

  // Drops what is without answer. Close first to wait for it.
  ~SessionStream() override;

  // Hands over a frame; its slot and rising sequence number are the caller's.
  // EVERY_FRAME blocks while the window is full, also during a loss.
  // LATEST_WINS never blocks. INVALID_ARGUMENT for a bad slot or number (what
  // is in the frame, the server judges: see PoseFrame.status),
  // DEADLINE_EXCEEDED when the window stays full, CANCELLED after Close,
  // RESOURCE_EXHAUSTED when too many patches of goals wait with LATEST_WINS;
  // otherwise why the slot ended.
  absl::Status Send(v1::TargetFrame frame,
                    absl::Duration timeout = absl::InfiniteDuration());

  // The same, with the next sequence number of the frame's slot, which is
  // returned.
  absl::StatusOr<int64_t> SendNext(
      v1::TargetFrame frame, absl::Duration timeout = absl::InfiniteDuration());

  // The next answer: per slot in order of sequence numbers, each once, and
  // between them those that no frame asked for (FrameTiming.filled). Nothing
  // when none came within `timeout`. A slot that ended (taken over: ABORTED,
  // deleted or expired: NOT_FOUND) says so once; the others go on. OUT_OF_RANGE
  // at the end of a stream that was closed; when it broke for good, why.
  //
  // Answers wait here until they are received: who sends for ever should
  // receive, too.
  absl::StatusOr<std::optional<v1::PoseFrame>> Receive(absl::Duration timeout);

  // Takes no more frames, waits for the answers, half-closes. OK when every
  // frame was answered; DEADLINE_EXCEEDED naming how many were not. Answers
  // remain to be received. The sessions stay on the server until they expire.
  absl::Status Close(absl::Duration timeout);

  // The specs in use: with the chosen ids.
  std::vector<SessionSpec> specs() const;
  // Newest one of the slot; frames must be above it. 0 when there is no such
  // slot.
  int64_t LastSequenceNumber(int slot) const;
  StreamStatistics statistics() const;

 private:
  using Lock = std::unique_lock<std::mutex>;

  SessionStream(std::shared_ptr<Connection> connection,
                const SessionStreamOptions& options,
                std::vector<SessionSpec> specs, uint64_t seed);

  absl::Status WaitUntilAttached();
  absl::Status Push(Lock& lock, v1::TargetFrame frame, bool number,
                    absl::Duration timeout, int64_t* sequence_number);

  // The thread that keeps the stream alive: attempt after attempt until there
  // is nothing left to do, or no hope. Functions with a lock want it held, and
  // may let go of it in between.
  void Run();
  absl::Status RunAttempt(Lock& lock);
  absl::Status RunCall(Lock& lock);
  absl::Status CreateAbsent(Lock& lock);
  bool WaitToRetry(Lock& lock, const absl::Status& failure);
  void Finish(absl::Status status);

  // What the call in progress should do; mutex_ held.
  bool IsComplete() const;
  bool ShouldHalfClose() const;
  SteadyTime CallDeadline() const;
  absl::Status StatusOfCall() const;
  // Writes what there is to say, if the call takes it; mutex_ held.
  void Pump();

  void OnResponse(v1::StreamingSolveResponse* response) override;
  void OnWritten() override;
  void OnEnd(absl::Status status) override;

  const std::shared_ptr<Connection> connection_;
  const SessionStreamOptions options_;

  mutable std::mutex mutex_;
  std::condition_variable run_event_;      // for Run
  std::condition_variable send_event_;     // for Send
  std::condition_variable receive_event_;  // for Receive
  std::condition_variable state_event_;    // for Open and Close

  SlotTable slots_;
  std::deque<v1::PoseFrame> answers_;
  // Slots whose end has been told by Receive.
  std::vector<bool> told_;

  // The attempt in progress.
  std::unique_ptr<StreamCall> call_;
  std::optional<absl::Status> call_status_;  // set at its end
  std::optional<absl::Status> closing_;      // the server said so
  std::optional<absl::Status> new_attempt_;  // this one is of no use
  bool draining_ = false;
  bool silent_ = false;
  SteadyTime last_arrival_;
  SteadyTime half_close_time_;

  // All attempts.
  Backoff backoff_;
  std::optional<SteadyTime> failing_since_;
  absl::Status last_failure_;
  bool opened_ = false;

  bool closing_down_ = false;  // Close was called
  bool abandoned_ = false;     // nobody waits any more
  std::optional<absl::Status> final_status_;

  Cancellation cancellation_;
  std::thread thread_;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_SESSION_STREAM_H_
