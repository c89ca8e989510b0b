#include "server/session/revision_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/session/resource_name.h"
#include "tests/testing/status_matchers.h"

namespace gelenk::server {
namespace {

using ::gelenk::testing::Fails;

TEST(RevisionNameTest, IsTheNewestWithoutANumber) {
  const RevisionedName name =
      ParseRevisionName("name", kSkins, "skins/body").value();
  EXPECT_EQ(name.name, "skins/body");
  EXPECT_EQ(name.revision, std::nullopt);
}

TEST(RevisionNameTest, ComesBackFromItsText) {
  for (int64_t revision : {int64_t{1}, int64_t{42}, int64_t{1} << 62}) {
    const RevisionedName name =
        ParseRevisionName("name", kSkins, RevisionText("skins/body", revision))
            .value();
    EXPECT_EQ(name.name, "skins/body");
    EXPECT_EQ(name.revision, revision);
  }
}

TEST(RevisionNameTest, IsWrittenInOneWayOnly) {
  for (const char* text :
       {"skins/body@", "skins/body@0", "skins/body@-1", "skins/body@+1",
        "skins/body@01", "skins/body@ 1", "skins/body@1 ", "skins/body@1@2",
        "skins/body@x", "skins/body@99999999999999999999"}) {
    EXPECT_THAT(ParseRevisionName("skin", kSkins, text).status(),
                Fails(absl::StatusCode::kInvalidArgument,
                      "skin: want skins/body@{revision}"))
        << text;
  }
  for (const char* text : {"", "@1", "body@1", "sessions/body@1", "skins/@1"}) {
    EXPECT_THAT(
        ParseRevisionName("skin", kSkins, text).status(),
        Fails(absl::StatusCode::kInvalidArgument, "skin: want skins/{id}, got"))
        << text;
  }
}

}  // namespace
}  // namespace gelenk::server
