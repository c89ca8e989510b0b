// Clients that send and do not read: they are held, they cost a bounded amount
// of memory, they are cut off in the end, and nobody else notices.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/time/clock.h"
#include "tests/integration/service_test.h"
#include "tests/testing/sanitizer.h"

namespace gelenk {
namespace {

using testing::ArmSessionRequest;
using testing::AttachRequest;
using testing::kPatience;
using testing::kSanitized;
using testing::SolveStream;
using testing::WholeFrame;
using v1::StreamEvent;

// Some 100 MB of frames: more than all buffers on the way.
constexpr int kMostFrames = 1000000;
constexpr int kBatch = 1000;
// What one stream may make the server hold: its window of HTTP/2 (256 KB), the
// message that it is at, the answers that wait, and as much again for what the
// allocator rounds up.
constexpr int64_t kBytesPerStream = 2 << 20;

class SlowReaderTest : public ServiceTest {
 protected:
  static void SetUpTestSuite() { StartServer({"--write-stall", "3s"}); }

  // Sends without reading until nothing is taken any more; the frames that
  // were.
  static int SendUntilHeld(SolveStream& stream, int first = 1) {
    int sent = first - 1;
    while (sent < kMostFrames) {
      v1::StreamingSolveRequest request;
      for (int i = 0; i < kBatch; ++i)
        *request.add_frames() = WholeFrame(++sent);
      if (!stream.Send(request, absl::Milliseconds(300))) break;
    }
    EXPECT_LT(sent, kMostFrames) << "nothing held the sender";
    return sent;
  }

  // Attached in the end: the session is free.
  static void ExpectFree(const std::string& session) {
    const auto stream = OpenStream();
    const absl::Time deadline = absl::Now() + kPatience;
    StreamEvent event;
    while (event.kind() != StreamEvent::KIND_ATTACHED &&
           absl::Now() < deadline) {
      ASSERT_TRUE(stream->Attach(AttachRequest(session)));
      event = stream->NextNews().value();
      absl::SleepFor(absl::Milliseconds(50));
    }
    EXPECT_EQ(event.kind(), StreamEvent::KIND_ATTACHED);
  }
};

TEST_F(SlowReaderTest, IsHeldThenCutOffAndNobodyElseNotices) {
  const std::string session = CreateSession();
  const auto slow = OpenStream({AttachRequest(session)});
  client::Connection elsewhere(server().target());
  // On the connection of the slow one, and on another.
  const auto beside = OpenStream({AttachRequest(CreateSession())});
  SolveStream apart(elsewhere.sessions());
  ASSERT_TRUE(apart.Attach(AttachRequest(CreateSession())));

  const int sent = SendUntilHeld(*slow);
  std::cout << "held after " << sent << " frames\n";
  for (int i = 1; i <= 500; ++i) {
    for (SolveStream* stream : {beside.get(), &apart}) {
      ASSERT_TRUE(stream->SendFrame(WholeFrame(i)));
      const auto answer = stream->NextFrame();
      ASSERT_TRUE(answer);
      ASSERT_EQ(answer->sequence_number(), i);
      ASSERT_EQ(answer->status().code(), 0);
    }
  }
  ExpectFree(session);
  // What was on its way still arrives, in order; then the stream is over.
  int64_t newest = 0;
  while (const auto answer = slow->NextFrame()) {
    ASSERT_EQ(answer->sequence_number(), ++newest);
  }
  EXPECT_GT(newest, 0);
  EXPECT_LT(newest, sent);
  EXPECT_FALSE(slow->Finish().ok());
  ASSERT_TRUE(beside->SendFrame(WholeFrame(501)));
  EXPECT_TRUE(beside->NextFrame());
}

TEST_F(SlowReaderTest, CostsABoundedAmountOfMemory) {
  constexpr int kStreams = 8;
  std::vector<std::unique_ptr<client::Connection>> connections;
  std::vector<std::unique_ptr<SolveStream>> streams;
  const int64_t before = server().resident_bytes();
  for (int i = 0; i < kStreams; ++i) {
    connections.push_back(
        std::make_unique<client::Connection>(server().target()));
    streams.push_back(
        std::make_unique<SolveStream>(connections.back()->sessions()));
    ASSERT_TRUE(streams.back()->Attach(AttachRequest(CreateSession())));
  }
  int64_t most = 0;
  for (const auto& stream : streams) {
    const int sent = SendUntilHeld(*stream);
    most = std::max(most, server().resident_bytes() - before);
    std::cout << sent << " frames, " << (most >> 10) << " KiB\n";
  }
  if (!kSanitized) {
    EXPECT_LE(most, kStreams * kBytesPerStream);
  }
}

}  // namespace
}  // namespace gelenk
