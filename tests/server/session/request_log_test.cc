#include "server/session/request_log.h"

#include <gtest/gtest.h>

#include "absl/strings/str_cat.h"

namespace gelenk::server {
namespace {

TEST(RequestLogTest, RemembersWhatARequestMade) {
  RequestLog log;
  log.Add("tenant", "request", "sessions/hand");
  EXPECT_EQ(log.Find("tenant", "request"), "sessions/hand");
  EXPECT_EQ(log.Find("tenant", "another"), "");
  EXPECT_EQ(log.Find("somebody", "request"), "");
}

TEST(RequestLogTest, DoesNotRememberRequestsWithoutId) {
  RequestLog log;
  log.Add("tenant", "", "sessions/hand");
  EXPECT_EQ(log.Find("tenant", ""), "");
}

TEST(RequestLogTest, TheNewestResultCounts) {
  RequestLog log;
  log.Add("tenant", "request", "sessions/hand");
  log.Add("tenant", "request", "sessions/foot");
  EXPECT_EQ(log.Find("tenant", "request"), "sessions/foot");
}

TEST(RequestLogTest, ForgetsTheOldest) {
  RequestLog log;
  const int count = static_cast<int>(RequestLog::kCapacity);
  for (int i = 0; i < count; ++i) log.Add("t", absl::StrCat(i), "name");
  EXPECT_EQ(log.Find("t", "0"), "name");
  log.Add("t", "one more", "name");
  EXPECT_EQ(log.Find("t", "0"), "");
  EXPECT_EQ(log.Find("t", "1"), "name");
  EXPECT_EQ(log.Find("t", "one more"), "name");
}

}  // namespace
}  // namespace gelenk::server
