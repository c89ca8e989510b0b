#include "server/session/resource_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/testing/violation_lines.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;

TEST(ResourceIdTest, TakesSmallLettersDigitsAndHyphens) {
  for (const char* id : {"abcd", "a123", "a---", "left-hand-2"}) {
    EXPECT_TRUE(CheckResourceId("session_id", id).ok()) << id;
  }
}

TEST(ResourceIdTest, RefusesEverythingElse) {
  for (const char* id :
       {"Abcd", "1abc", "-abc", "ab_c", "ab/c", "ab.c", "ab c", "abc\n",
        "\xc3\xa4"
        "bcd",
        ""}) {
    EXPECT_EQ(CheckResourceId("session_id", id).code(),
              absl::StatusCode::kInvalidArgument)
        << id;
  }
}

TEST(ResourceIdTest, HasFourToSixtyThreeBytes) {
  EXPECT_FALSE(CheckResourceId("session_id", std::string(3, 'a')).ok());
  EXPECT_TRUE(CheckResourceId("session_id", std::string(4, 'a')).ok());
  EXPECT_TRUE(CheckResourceId("session_id", std::string(63, 'a')).ok());
  EXPECT_FALSE(CheckResourceId("session_id", std::string(64, 'a')).ok());
}

TEST(ResourceIdTest, SaysFieldAndValue) {
  EXPECT_THAT(
      ViolationLines(CheckResourceId("session_id", "Hand")),
      ElementsAre("session_id: want [a-z][a-z0-9-]{3,62}, got \"Hand\""));
}

TEST(ResourceIdTest, ShowsHostileValuesShortAndPrintable) {
  const std::string shown =
      ViolationLines(CheckResourceId("id", "\n\x01" + std::string(1000, 'x')))
          .front();
  EXPECT_LT(shown.size(), 200);
  EXPECT_EQ(shown.find('\n'), std::string::npos);
}

TEST(ResourceNameTest, TakesNamesOfItsCollection) {
  EXPECT_TRUE(CheckResourceName("name", kSessions, "sessions/hand").ok());
  for (const char* name :
       {"sessions", "sessions/", "sessions/Hand", "sessionshand",
        "sessions/hand/x", "skeletons/hand", "hand", ""}) {
    EXPECT_FALSE(CheckResourceName("name", kSessions, name).ok()) << name;
  }
  EXPECT_THAT(
      ViolationLines(CheckResourceName("name", kSessions, "skeletons/hand")),
      ElementsAre("name: want sessions/{id}, got \"skeletons/hand\""));
}

TEST(ResourceNameTest, MadeIdsAreIds) {
  EXPECT_EQ(MakeResourceId("s", 0), "s-0000000000000000");
  EXPECT_EQ(MakeResourceId("s", ~uint64_t{0}), "s-ffffffffffffffff");
  EXPECT_TRUE(CheckResourceId("id", MakeResourceId("k", 77)).ok());
}

TEST(RequestIdTest, HasAtMostSixtyFourBytes) {
  EXPECT_TRUE(CheckRequestId("").ok());
  EXPECT_TRUE(CheckRequestId(std::string(64, 'x')).ok());
  EXPECT_THAT(ViolationLines(CheckRequestId(std::string(65, 'x'))),
              ElementsAre("request_id: want at most 64 bytes, got 65"));
}

}  // namespace
}  // namespace gelenk::server
