// One session of a stream: what was sent, what was answered, and how to go on
// after a loss.
#ifndef GELENK_CLIENT_SLOT_H_
#define GELENK_CLIENT_SLOT_H_

#include <cstdint>
#include <deque>
#include <optional>

#include "absl/status/status.h"
#include "gelenk/client/creation.h"
#include "gelenk/client/effective_goals.h"
#include "gelenk/client/session_spec.h"
#include "gelenk/client/steady_time.h"
#include "gelenk/client/stream_statistics.h"

namespace gelenk::client {

// The state behind exact continuation. Keeps every frame until it is answered,
// the last answer, and the goals as that answer left them; so the session can
// be brought back on any server: created from the goals and the pose, resumed
// from the answer, and given the frames without answer again.
//
// No thread, no clock, no wire: the stream tells it what happened. Not
// thread-safe.
class Slot {
 public:
  enum class Phase {
    kAbsent,    // to be created
    kDetached,  // to be attached
    kAttaching,
    kAttached,
    kEnded,  // see status()
  };

  // `spec` as Complete() leaves it.
  Slot(int index, SessionSpec spec);

  Phase phase() const { return phase_; }
  // Why it ended.
  const absl::Status& status() const { return status_; }
  void End(absl::Status status);

  // --- Creation ---
  const SessionSpec& spec() const { return spec_; }
  bool NeedsAdoption() const { return !spec_.session.has_session(); }
  void SetAdopted(SessionSpec spec);
  // What creates the session as of the last answer; exactly as first when
  // nothing was solved yet, so that a cold start stays cold.
  Creation NextCreation();
  void SetCreated();

  // --- Loss and return ---
  // The connection is gone: attach again, and everything without answer is
  // unsent again (LATEST_WINS: merged into one).
  void Rewind(StreamStatistics* statistics);
  void Attach(v1::AttachSession* request);
  // Answers to an attach. What cannot be mended on this connection is returned
  // as UNAVAILABLE: a new attempt is needed.
  absl::Status OnAttached(const v1::StreamEvent& event,
                          StreamStatistics* statistics);
  absl::Status OnDetached(const v1::StreamEvent& event);

  // --- Frames ---
  // INVALID_ARGUMENT unless `sequence_number` is above all before it.
  absl::Status CheckNumber(int64_t sequence_number) const;
  int64_t last_sequence_number() const { return last_pushed_; }
  // Whether Push may be called: with EVERY_FRAME less than `window` frames wait
  // for an answer; with LATEST_WINS, that there is something to merge with.
  bool HasRoom(const v1::TargetFrame& frame, int window) const;
  void Push(v1::TargetFrame frame, SteadyTime now,
            StreamStatistics* statistics);
  // Moves up to `max_frames` to the end of `request`, and marks them sent; at
  // most `window` are under way. Returns how many.
  int Send(int max_frames, int window, v1::StreamingSolveRequest* request,
           StreamStatistics* statistics);
  // False when it was answered before.
  bool Settle(const v1::PoseFrame& answer, SteadyTime now,
              StreamStatistics* statistics);
  // Of an answer that no frame asked for (FrameTiming.filled): goes on from it.
  // False when a later frame was answered before.
  bool TakeFill(const v1::PoseFrame& answer);
  int unanswered_count() const { return static_cast<int>(waiting_.size()); }

 private:
  struct WaitingFrame {
    v1::TargetFrame frame;
    SteadyTime push_time;
    bool was_sent = false;
  };

  bool merges() const {
    return spec_.frame_policy != v1::FRAME_POLICY_EVERY_FRAME;
  }
  bool CanMerge(const v1::TargetFrame& frame) const;
  // Where the session is now.
  void NoteAnswer(const v1::PoseFrame& answer);
  void MergeWaiting(StreamStatistics* statistics);
  absl::Status Replace(absl::string_view reason);
  // What frames without answer may have done to the session.
  struct Traces {
    bool patches = false;
    EffectiveGoals::Wanted unsettled = {false, false};
  };
  Traces TracesOfSent() const;

  const int index_;
  SessionSpec spec_;
  Phase phase_;
  absl::Status status_;

  EffectiveGoals goals_;
  // Last answer: number, capture time, pose, continuation. The pose only once a
  // frame was solved.
  v1::PoseFrame answered_;
  bool was_solved_ = false;
  bool was_attached_ = false;
  int creation_count_ = 0;
  // Created since the last Rewind.
  bool just_created_ = false;
  // The server's session is ahead of this client, in ways that no resume takes
  // back.
  bool replace_ = false;
  // After a resume without continuation frames go one by one and say
  // everything, until one was accepted: the session may be the old one, whose
  // goals were moved by frames that count as never sent.
  bool probing_ = false;

  // Sent ones first; their number is sent_count_.
  std::deque<WaitingFrame> waiting_;
  int sent_count_ = 0;
  int64_t last_pushed_ = 0;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_SLOT_H_
