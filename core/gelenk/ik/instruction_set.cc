#include "gelenk/ik/instruction_set.h"

namespace gelenk {

absl::string_view InstructionSetName(InstructionSet level) {
  switch (level) {
    case InstructionSet::kBaseline:
      return "baseline";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
  }
  return "unknown";
}

std::optional<InstructionSet> InstructionSetFromName(absl::string_view name) {
  for (InstructionSet level : {InstructionSet::kBaseline, InstructionSet::kAvx2,
                               InstructionSet::kAvx512}) {
    if (InstructionSetName(level) == name) return level;
  }
  return std::nullopt;
}

std::vector<InstructionSet> SupportedInstructionSets() {
  std::vector<InstructionSet> levels = {InstructionSet::kBaseline};
#ifdef GELENK_X86_LEVELS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    levels.push_back(InstructionSet::kAvx2);
    if (__builtin_cpu_supports("avx512f") &&
        __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
      levels.push_back(InstructionSet::kAvx512);
    }
  }
#endif
  return levels;
}

InstructionSet BestInstructionSet() {
  return SupportedInstructionSets().back();
}

}  // namespace gelenk
