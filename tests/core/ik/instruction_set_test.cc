#include "gelenk/ik/instruction_set.h"

#include <gtest/gtest.h>

namespace gelenk {
namespace {

TEST(InstructionSetTest, NamesComeBack) {
  for (InstructionSet level : {InstructionSet::kBaseline, InstructionSet::kAvx2,
                               InstructionSet::kAvx512}) {
    EXPECT_EQ(InstructionSetFromName(InstructionSetName(level)), level);
  }
  EXPECT_EQ(InstructionSetFromName("AVX2"), std::nullopt);
  EXPECT_EQ(InstructionSetFromName(""), std::nullopt);
}

TEST(InstructionSetTest, BaselineIsAlwaysThereAndBestIsLast) {
  const std::vector<InstructionSet> levels = SupportedInstructionSets();
  ASSERT_FALSE(levels.empty());
  EXPECT_EQ(levels.front(), InstructionSet::kBaseline);
  EXPECT_EQ(levels.back(), BestInstructionSet());
  for (size_t i = 1; i < levels.size(); ++i)
    EXPECT_LT(levels[i - 1], levels[i]);
}

}  // namespace
}  // namespace gelenk
