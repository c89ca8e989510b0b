// A real gelenkd with a walker and a hero: sessions on the hero follow the
// walker.
#ifndef GELENK_TESTS_INTEGRATION_FOLLOWER_TEST_H_
#define GELENK_TESTS_INTEGRATION_FOLLOWER_TEST_H_

#include <gtest/gtest.h>

#include "tests/integration/service_test.h"
#include "tests/testing/followed_body.h"

namespace gelenk {

class FollowerTest : public ServiceTest {
 protected:
  static constexpr int kClipFrames = 90;

  static void SetUpTestSuite() {
    StartServer({});
    for (const auto& request :
         {testing::WalkerRequest(Clip()), testing::HeroRequest()}) {
      ASSERT_EQ(
          Call(&v1::KinematicsService::Stub::CreateSkeleton, request).status(),
          absl::OkStatus());
    }
  }

  static const testing::BodyClip& Clip() {
    static const auto* const kClip =
        new testing::BodyClip(testing::WalkClip(kClipFrames));
    return *kClip;
  }

  static v1::CreateSessionRequest Follower(
      const v1::StreamConditioning& conditioning) {
    v1::CreateSessionRequest request = testing::FollowerRequest(Clip());
    *request.mutable_session()->mutable_conditioning() = conditioning;
    return request;
  }
};

}  // namespace gelenk

#endif  // GELENK_TESTS_INTEGRATION_FOLLOWER_TEST_H_
