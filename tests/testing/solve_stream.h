// One StreamingSolve by hand, without the client library's care: what is sent
// is what the test says, and nothing is sent again. Every wait is bounded.
#ifndef GELENK_TESTS_TESTING_SOLVE_STREAM_H_
#define GELENK_TESTS_TESTING_SOLVE_STREAM_H_

#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/support/async_stream.h>

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "gelenk/v1/session_service.grpc.pb.h"

namespace gelenk::testing {

// No wait of a test that passes comes near it.
inline constexpr absl::Duration kPatience = absl::Seconds(30);

// Not thread-safe. Reads only while something is waited for, so that a test can
// be a client that does not read.
class SolveStream {
 public:
  // Opens the stream on `stub`, which must outlive it.
  explicit SolveStream(v1::SessionService::Stub& stub);
  // Cancels what is not over.
  ~SolveStream();
  SolveStream(const SolveStream&) = delete;
  SolveStream& operator=(const SolveStream&) = delete;

  // False when flow control holds the message for `patience` (it stays under
  // way, and the next Send waits for it first), or when the stream is over.
  bool Send(const v1::StreamingSolveRequest& request,
            absl::Duration patience = kPatience);
  bool Attach(const v1::AttachSession& attach);
  bool SendFrame(const v1::TargetFrame& frame);

  // The next answer or event, in their order; the others are kept for their
  // turn. None when the stream ends or `patience` is over.
  std::optional<v1::PoseFrame> NextFrame(absl::Duration patience = kPatience);
  std::optional<v1::StreamEvent> NextEvent(absl::Duration patience = kPatience);
  // Up to `count` answers.
  std::vector<v1::PoseFrame> NextFrames(int count);
  // The next event that is no heartbeat.
  std::optional<v1::StreamEvent> NextNews(absl::Duration patience = kPatience);

  // Messages that were read so far.
  int message_count() const { return message_count_; }

  void HalfClose();
  void Cancel() { context_.TryCancel(); }
  // Reads to the end and returns the status of the stream; cancels it when the
  // end does not come.
  absl::Status Finish();

 private:
  enum Tag : int { kStart, kRead, kWrite, kHalfClose, kFinish, kTagCount };

  // Waits until `tag` is not under way; false when it is after `patience`.
  bool Await(Tag tag, absl::Duration patience);
  void Begin(Tag tag) { under_way_[tag] = true; }
  void* Pointer(Tag tag) { return &under_way_[tag]; }
  // Reads one message; false at the end, or after `patience`.
  bool Read(absl::Duration patience);
  void TakeMessage();

  grpc::ClientContext context_;
  grpc::CompletionQueue queue_;
  std::unique_ptr<grpc::ClientAsyncReaderWriter<v1::StreamingSolveRequest,
                                                v1::StreamingSolveResponse>>
      stream_;
  bool under_way_[kTagCount] = {};
  bool ok_[kTagCount] = {true, true, true, true, true};
  v1::StreamingSolveResponse response_;
  std::deque<v1::PoseFrame> frames_;
  std::deque<v1::StreamEvent> events_;
  grpc::Status status_;
  int message_count_ = 0;
  bool half_closed_ = false;
  bool finished_ = false;
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_SOLVE_STREAM_H_
