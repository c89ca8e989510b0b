#include "server/session/session_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/testing/example_skeletons.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::Fails;
using ::gelenk::testing::PlanarChain;
using ::testing::ElementsAre;

constexpr absl::Time kNow = absl::FromUnixSeconds(1000);

class SessionRecordingTest : public ::testing::Test {
 protected:
  SessionRecording Recording(int max_frames = 9) const {
    return {chain_, max_frames, nullptr};
  }
  static std::vector<double> Times(const SessionRecording& recording) {
    return recording.ToClip("").value().track(0).times_s;
  }

  const std::shared_ptr<const Skeleton> chain_ =
      PlanarChain(Eigen::Vector3d::Zero(), {1, 1});
  const Eigen::VectorXd pose_ = Eigen::Vector2d(0.1, 0.2);
};

TEST_F(SessionRecordingTest, TimesAreThoseOfTheCapture) {
  SessionRecording recording = Recording();
  for (int i = 0; i < 3; ++i) {
    recording.Note(absl::Seconds(2 + i), kNow, pose_);
  }
  EXPECT_THAT(Times(recording), ElementsAre(0, 1, 2));
  EXPECT_EQ(recording.left_out_count(), 0);
}

TEST_F(SessionRecordingTest, WithoutThemTheyAreTheServers) {
  SessionRecording recording = Recording();
  recording.Note(std::nullopt, kNow, pose_);
  recording.Note(absl::Seconds(77), kNow + absl::Seconds(1), pose_);
  EXPECT_THAT(Times(recording), ElementsAre(0, 1));
}

TEST_F(SessionRecordingTest, FramesWhoseTimeDoesNotFollowAreLeftOut) {
  SessionRecording recording = Recording();
  recording.Note(absl::Seconds(2), kNow, pose_);
  recording.Note(absl::Seconds(2), kNow + absl::Seconds(1), pose_);
  recording.Note(std::nullopt, kNow + absl::Seconds(2), pose_);
  recording.Note(absl::Seconds(3), kNow + absl::Seconds(3), pose_);
  EXPECT_THAT(Times(recording), ElementsAre(0, 1));
  EXPECT_EQ(recording.left_out_count(), 2);
}

TEST_F(SessionRecordingTest, AFullOneTakesNoMore) {
  SessionRecording recording = Recording(2);
  for (int i = 0; i < 5; ++i) {
    recording.Note(absl::Seconds(i), kNow, pose_);
  }
  EXPECT_THAT(Times(recording), ElementsAre(0, 1));
  EXPECT_EQ(recording.left_out_count(), 3);
}

TEST_F(SessionRecordingTest, AnEmptyOneIsNoClip) {
  EXPECT_THAT(Recording().ToClip("").status(),
              Fails(absl::StatusCode::kFailedPrecondition, "nothing"));
}

TEST(ReservedBytesTest, AreGivenBack) {
  std::atomic<int64_t> held{0};
  {
    const ReservedBytes first(held, 60, 100);
    EXPECT_TRUE(first.granted());
    const ReservedBytes second(held, 60, 100);
    EXPECT_FALSE(second.granted());
  }
  EXPECT_EQ(held, 0);
}

}  // namespace
}  // namespace gelenk::server
