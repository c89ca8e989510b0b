#include "gelenk/ik/newton_1d.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/testing/violation_lines.h"

namespace gelenk {
namespace {

using ::gelenk::testing::ViolationLines;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

double Square(double x) { return x * x - 2; }
double TwiceX(double x) { return 2 * x; }

// Heron's iterates of the root of two.
TEST(Newton1dTest, TangentsOfTheRootOfTwo) {
  Newton1dOptions options;
  options.start = 1;
  const auto result = FindZero(Square, TwiceX, options).value();
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x, std::sqrt(2), 1e-14);
  ASSERT_GE(result.tangents.size(), 4u);
  EXPECT_EQ(result.tangents[0].slope, 2);
  EXPECT_DOUBLE_EQ(result.tangents[1].x, 3.0 / 2);
  EXPECT_DOUBLE_EQ(result.tangents[2].x, 17.0 / 12);
  EXPECT_DOUBLE_EQ(result.tangents[3].x, 577.0 / 408);
  EXPECT_EQ(result.zero_count, ZeroCount::kUnknown);
}

TEST(Newton1dTest, FiniteDifferencesDoAsWell) {
  Newton1dOptions options;
  options.start = 1;
  const auto result = FindZero(Square, nullptr, options).value();
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x, std::sqrt(2), 1e-12);
  EXPECT_NEAR(result.tangents[0].slope, 2, 1e-6);
}

TEST(Newton1dTest, NoneOneAndManyAsFarAsTheBracketShows) {
  Newton1dOptions options;
  options.bracket = {-3, 3};
  options.start = 1;
  EXPECT_EQ(FindZero(Square, nullptr, options)->zero_count, ZeroCount::kMany);
  EXPECT_THAT(FindZero(Square, nullptr, options)->seen_zeros, SizeIs(2));
  options.bracket = {0, 3};
  EXPECT_EQ(FindZero(Square, nullptr, options)->zero_count, ZeroCount::kOne);
  const auto none =
      FindZero([](double x) { return x * x + 1; }, nullptr, options).value();
  EXPECT_EQ(none.zero_count, ZeroCount::kNone);
  EXPECT_THAT(none.seen_zeros, IsEmpty());
  EXPECT_FALSE(none.converged);
}

// The plain method runs away from here; the bracket brings it back.
TEST(Newton1dTest, FallsBackOnTheBracket) {
  const auto arc = [](double x) { return std::atan(x); };
  Newton1dOptions options;
  options.start = 3;
  EXPECT_FALSE(FindZero(arc, nullptr, options)->converged);
  options.bracket = {-10, 11};
  const auto result = FindZero(arc, nullptr, options).value();
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x, 0, 1e-12);
}

TEST(Newton1dTest, NoSlopeIsSingularWithoutABracket) {
  Newton1dOptions options;
  options.start = 0;
  const auto lost = FindZero(Square, TwiceX, options).value();
  EXPECT_TRUE(lost.singular);
  EXPECT_FALSE(lost.converged);
  EXPECT_EQ(lost.x, 0);
  options.bracket = {-1, 2};
  EXPECT_TRUE(FindZero(Square, TwiceX, options)->converged);
}

TEST(Newton1dTest, NumbersThatAreNoneEndIt) {
  const auto result = FindZero([](double) { return NAN; }, nullptr, {}).value();
  EXPECT_FALSE(result.converged);
}

TEST(Newton1dTest, NamesEveryBadField) {
  Newton1dOptions options;
  options.start = NAN;
  options.bracket = {1, 1};
  options.sample_count = 1;
  options.max_iterations = -1;
  options.tolerance = 0;
  EXPECT_THAT(
      ViolationLines(FindZero(Square, nullptr, options).status()),
      ElementsAre(HasSubstr("start: "), HasSubstr("bracket: "),
                  HasSubstr("sample_count: "), HasSubstr("max_iterations: "),
                  HasSubstr("tolerance: ")));
}

}  // namespace
}  // namespace gelenk
