// The levels of the instruction set that the solver's inner loop is compiled
// for. Fused multiply-add changes bits: answers repeat bit by bit on the same
// build and the same level only.
#ifndef GELENK_IK_INSTRUCTION_SET_H_
#define GELENK_IK_INSTRUCTION_SET_H_

#include <optional>
#include <vector>

#include "absl/strings/string_view.h"

namespace gelenk {

enum class InstructionSet { kBaseline, kAvx2, kAvx512 };

// "baseline", "avx2", "avx512".
absl::string_view InstructionSetName(InstructionSet level);
std::optional<InstructionSet> InstructionSetFromName(absl::string_view name);

// The levels that this build has and this processor runs, lowest first.
std::vector<InstructionSet> SupportedInstructionSets();

// The highest of them.
InstructionSet BestInstructionSet();

}  // namespace gelenk

#endif  // GELENK_IK_INSTRUCTION_SET_H_
