#include "gelenk/formats/unique_names.h"

#include <gtest/gtest.h>

#include <string>

namespace gelenk {
namespace {

constexpr char kReplacement[] = "\xEF\xBF\xBD";

TEST(UniqueNamesTest, NumbersWhatComesAgain) {
  UniqueNames names(20);
  EXPECT_EQ(names.Take("arm"), "arm");
  EXPECT_EQ(names.Take("arm"), "arm#2");
  EXPECT_EQ(names.Take("leg"), "leg");
  EXPECT_EQ(names.Take("arm"), "arm#3");
}

TEST(UniqueNamesTest, StepsOverNamesThatLookNumbered) {
  UniqueNames names(20);
  EXPECT_EQ(names.Take("arm#2"), "arm#2");
  EXPECT_EQ(names.Take("arm"), "arm");
  EXPECT_EQ(names.Take("arm"), "arm#3");
  EXPECT_EQ(names.Take("arm#2"), "arm#2#2");
}

TEST(UniqueNamesTest, KeepsNamesWithinTheirBytes) {
  UniqueNames names(5);
  EXPECT_EQ(names.Take("forearm"), "forea");
  EXPECT_EQ(names.Take("forearms"), "for#2");
  // Never half a character.
  EXPECT_EQ(names.Take("armé"), "armé");
  EXPECT_EQ(names.Take("armé"), "arm#2");
}

TEST(UniqueNamesTest, ManyEqualNamesStayCheap) {
  UniqueNames names(63);
  for (int i = 1; i < 100000; ++i) names.Take("x");
  EXPECT_EQ(names.Take("x"), "x#100000");
}

TEST(PrintableUtf8Test, KeepsUtf8OfEveryLength) {
  const std::string text = "Hüfte 腰 🦴 mixamorig:Hips";
  EXPECT_EQ(PrintableUtf8(text), text);
}

TEST(PrintableUtf8Test, ReplacesWhatIsNoText) {
  EXPECT_EQ(PrintableUtf8("a\tb"), std::string("a") + kReplacement + "b");
  EXPECT_EQ(PrintableUtf8("\xE9t\xE9"),
            std::string(kReplacement) + "t" + kReplacement);
  // Overlong, surrogate, beyond U+10FFFF, cut short.
  for (const char* bad : {"\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80",
                          "\xF4\x90\x80\x80", "\xF0\x9F\xA6"}) {
    EXPECT_EQ(PrintableUtf8(bad).substr(0, 3), kReplacement);
  }
}

}  // namespace
}  // namespace gelenk
