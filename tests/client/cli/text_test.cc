#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/cli/progress_bar.h"
#include "client/cli/text/format.h"
#include "client/cli/text/number_list.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string MessageOf(const absl::Status& status) {
  return std::string(status.message());
}

TEST(TableTest, AlignsColumnsAndLeavesNoBlanksBehind) {
  Table table({{"JOINT"}, {"X (m)", Align::kRight}, {"NOTE"}});
  table.AddRow({"hips", "12.5", ""});
  table.AddRow({"a", "-3", "far"});
  EXPECT_EQ(table.ToString(),
            "JOINT  X (m)  NOTE\n"
            "hips    12.5\n"
            "a         -3  far\n");
}

TEST(TableTest, CountsCharactersNotBytes) {
  EXPECT_EQ(DisplayWidth("Hüfte"), 5);
  Table table({{"N"}, {"V"}});
  table.AddRow({"Hüfte", "1"});
  table.AddRow({"Knie", "2"});
  EXPECT_EQ(table.ToString(), "N      V\nHüfte  1\nKnie   2\n");
}

TEST(TableTest, ShortRowsAreFilledUp) {
  Table table({{"A"}, {"B"}});
  table.AddRow({"x"});
  EXPECT_EQ(table.ToString(), "A  B\nx\n");
}

TEST(FactsTest, HaveNoTitles) {
  Facts facts;
  facts.Add("up", "+Y");
  facts.Add("frames", "12");
  EXPECT_EQ(facts.ToString(), "up      +Y\nframes  12\n");
}

TEST(NumberListTest, TakesCommasAndWhiteSpace) {
  EXPECT_THAT(*ParseNumbers("1, -2.5,3e-2"), ElementsAre(1, -2.5, 0.03));
  EXPECT_THAT(*ParseNumbers("1 2\n3\t4"), ElementsAre(1, 2, 3, 4));
}

TEST(NumberListTest, NamesWhatIsNoNumber) {
  EXPECT_EQ(MessageOf(ParseNumbers("1,x").status()),
            "want a number, got \"x\"");
  EXPECT_EQ(MessageOf(ParseNumbers("1,nan").status()),
            "want a number, got \"nan\"");
  EXPECT_EQ(MessageOf(ParseNumbers("inf").status()),
            "want a number, got \"inf\"");
  EXPECT_EQ(MessageOf(ParseNumbers("1,,2").status()),
            "want numbers separated by commas, got \"1,,2\"");
  EXPECT_EQ(MessageOf(ParseNumbers("").status()),
            "want numbers separated by commas, got \"\"");
}

TEST(NumberListTest, CountsWhenTold) {
  EXPECT_TRUE(ParseNumbers("1,2,3", 3).ok());
  EXPECT_EQ(MessageOf(ParseNumbers("1,2", 3).status()),
            "want 3 numbers, got 2 in \"1,2\"");
}

TEST(FormatTest, FixedHasNoMinusZero) {
  EXPECT_EQ(Fixed(-1e-9, 4), "0.0000");
  EXPECT_EQ(Fixed(-0.00006, 4), "-0.0001");
  EXPECT_EQ(Fixed(2, 1), "2.0");
}

TEST(FormatTest, SignificantKeepsDigitsThatCount) {
  EXPECT_EQ(Significant(0.0123456, 3), "0.0123");
  EXPECT_EQ(Significant(119.99, 4), "120");
}

TEST(FormatTest, PercentIsNeverRoundedToAllOrNothing) {
  EXPECT_EQ(Percent(2752, 2752), "100 %");
  EXPECT_EQ(Percent(99999, 100000), "99.99 %");
  EXPECT_EQ(Percent(1, 100000), "0.01 %");
  EXPECT_EQ(Percent(7, 8), "87.50 %");
  EXPECT_EQ(Percent(0, 8), "0 %");
  EXPECT_EQ(Percent(0, 0), "-");
}

TEST(FormatTest, JsonKeepsTheOrderOfKeysAndSurvivesBadBytes) {
  EXPECT_EQ(JsonText({{"b", 1}, {"a", "\xff"}}),
            "{\n  \"b\": 1,\n  \"a\": \"\xEF\xBF\xBD\"\n}\n");
}

TEST(ProgressLineTest, FillsUp) {
  EXPECT_THAT(ProgressLine("walk", 0, 8), HasSubstr("  0 %"));
  EXPECT_THAT(ProgressLine("walk", 4, 8),
              HasSubstr("[====================                    ]  50 %"));
  EXPECT_THAT(ProgressLine("walk", 9, 8), HasSubstr("100 %"));
  EXPECT_THAT(ProgressLine("walk", 0, 0), HasSubstr("100 %"));
}

}  // namespace
}  // namespace gelenk::cli
