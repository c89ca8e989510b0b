// The slots of one stream, and the messages that move them.
#ifndef GELENK_CLIENT_SLOT_TABLE_H_
#define GELENK_CLIENT_SLOT_TABLE_H_

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "gelenk/client/slot.h"

namespace gelenk::client {

// Writes requests, reads responses. No thread, no clock, no wire; not
// thread-safe.
class SlotTable {
 public:
  // What a response says about the stream itself.
  struct News {
    // The server goes away: half-close, connect again.
    bool draining = false;
    // The stream cannot go on, and why.
    std::optional<absl::Status> closing;
    // Some slot needs another connection, and why.
    std::optional<absl::Status> new_attempt;
    bool has_answers = false;
  };

  // Slot numbers are indices into `specs`, which are as Complete() leaves them.
  explicit SlotTable(std::vector<SessionSpec> specs);

  // Null when there is no such slot.
  Slot* Find(int slot);
  const std::deque<Slot>& slots() const { return slots_; }

  // The next slot to be created, or null.
  Slot* FindAbsent();

  // The connection is gone.
  void Rewind();
  // Ends the slots that have not ended.
  void End(const absl::Status& status);

  // True when there is something to say: attaches, and up to `max_frames`
  // frames; at most `window` frames of a slot are under way.
  bool Write(int max_frames, int window, v1::StreamingSolveRequest* request);

  // Moves answers not seen before to the end of `answers`.
  News Read(v1::StreamingSolveResponse* response, SteadyTime now,
            std::deque<v1::PoseFrame>* answers);

  bool AllAttached() const;
  bool AllEnded() const;
  int64_t unanswered_count() const;
  // First bad status of a slot that has ended.
  absl::Status status() const;
  StreamStatistics& statistics() { return statistics_; }
  const StreamStatistics& statistics() const { return statistics_; }

 private:
  void ReadEvent(const v1::StreamEvent& event, News* news);

  // Slots do not move.
  std::deque<Slot> slots_;
  // Whose turn it is, when not all frames fit into a message.
  size_t turn_ = 0;
  StreamStatistics statistics_;
};

}  // namespace gelenk::client

#endif  // GELENK_CLIENT_SLOT_TABLE_H_
