#include "gelenk/base/number_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::ViolationLines;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(NumberCheckTest, TakesTheBordersOfEachRange) {
  Violations violations;
  CheckNumber("a", -kLargestNumber, violations);
  CheckNotNegative("b", 0, violations);
  CheckPositive("c", std::numeric_limits<double>::denorm_min(), violations);
  CheckPositive("d", kLargestNumber, violations);
  CheckNumbers("e", Eigen::Vector2d(0, -kLargestNumber), violations);
  EXPECT_TRUE(violations.empty());
  EXPECT_THAT(ViolationLines(violations.ToStatus()), IsEmpty());
}

TEST(NumberCheckTest, SaysWhatItWantsAndWhatItGot) {
  Violations violations;
  CheckNumber("a", kNan, violations);
  CheckPositive("b", 0, violations);
  CheckNotNegative("c", -1, violations);
  CheckNotNegative("d", kInfinity, violations);
  CheckNumbers("e", Eigen::Vector3d(1, kNan, 3), violations);
  EXPECT_THAT(ViolationLines(violations.ToStatus()),
              ElementsAre("a: want a finite number, got nan",
                          "b: want a finite number > 0, got 0",
                          "c: want a finite number >= 0, got -1",
                          "d: want a finite number >= 0, got inf",
                          "e: want finite numbers, got (1, nan, 3)"));
}

TEST(NumberCheckTest, NamesTheLargestWhereThatIsWhatIsWrong) {
  Violations violations;
  CheckPositive("a", 1e13, violations);
  CheckNumbers("b", Eigen::Vector2d(0, -2e12), violations);
  EXPECT_THAT(
      ViolationLines(violations.ToStatus()),
      ElementsAre("a: want a finite number > 0 of at most 1e+12, got 1e+13",
                  "b: want finite numbers of at most 1e+12, got (0, -2e+12)"));
}

}  // namespace
}  // namespace gelenk
