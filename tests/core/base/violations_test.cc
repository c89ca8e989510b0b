#include "gelenk/base/violations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(ViolationsTest, NothingWrongIsOk) {
  Violations violations;
  EXPECT_TRUE(violations.empty());
  EXPECT_TRUE(violations.ToStatus().ok());
  EXPECT_THAT(Violations::FromStatus(absl::OkStatus()), IsEmpty());
}

TEST(ViolationsTest, MessageListsEverything) {
  Violations violations;
  violations.Add("goals[0].weight", "want a finite number >= 0, got -1");
  violations.Add("", "nothing to do");
  const absl::Status status = violations.ToStatus();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(),
            "goals[0].weight: want a finite number >= 0, got -1; nothing to "
            "do");
}

TEST(ViolationsTest, StatusCarriesThemThere) {
  Violations violations;
  violations.Add("up", "want a direction");
  violations.Add("", "no field, and : or . in the text");
  violations.Add("empty", "");
  EXPECT_THAT(ViolationLines(violations.ToStatus()),
              ElementsAre("up: want a direction",
                          ": no field, and : or . in the text", "empty: "));
}

TEST(ViolationsTest, OtherErrorsCarryNone) {
  EXPECT_THAT(Violations::FromStatus(absl::InternalError("disk full")),
              IsEmpty());
}

TEST(ViolationsTest, AddStatusPutsPathsBelowAField) {
  Violations inner;
  inner.Add("axis", "want a unit vector");
  inner.Add("", "too short");
  Violations outer;
  outer.AddStatus("joints[2]", inner.ToStatus());
  outer.AddStatus("joints[3]", absl::OkStatus());
  outer.AddStatus("joints[4]", absl::NotFoundError("no such joint"));
  EXPECT_THAT(ViolationLines(outer.ToStatus()),
              ElementsAre("joints[2].axis: want a unit vector",
                          "joints[2]: too short", "joints[4]: no such joint"));
}

TEST(ViolationsTest, AddStatusWithoutAFieldKeepsPaths) {
  Violations inner;
  inner.Add("axis", "want a unit vector");
  Violations outer;
  outer.AddStatus("", inner.ToStatus());
  EXPECT_THAT(ViolationLines(outer.ToStatus()),
              ElementsAre("axis: want a unit vector"));
}

class ViolationCountTest : public ::testing::TestWithParam<int> {};

TEST_P(ViolationCountTest, ListsTwentyAtMost) {
  Violations violations;
  for (int i = 0; i < GetParam(); ++i) {
    violations.Add("q[" + std::to_string(i) + "]", "bad");
  }
  const absl::Status status = violations.ToStatus();
  const std::string message(status.message());
  const int more = GetParam() - 20;
  EXPECT_THAT(Violations::FromStatus(status),
              SizeIs(more > 0 ? 20 : GetParam()));
  EXPECT_EQ(message.ends_with("; and " + std::to_string(more) + " more"),
            more > 0)
      << message;
}

INSTANTIATE_TEST_SUITE_P(AroundTwenty, ViolationCountTest,
                         ::testing::Values(1, 20, 21, 1000000));

}  // namespace
}  // namespace gelenk
