// The bones of Unity's humanoid, as the VMC protocol and VRM files name them.
#ifndef CLIENT_CLI_VMC_HUMAN_BONE_H_
#define CLIENT_CLI_VMC_HUMAN_BONE_H_

#include <array>

#include "absl/strings/string_view.h"

namespace gelenk::cli {

struct HumanBone {
  absl::string_view name;
  // Index of the bone that it hangs on where a body has all bones; -1 of the
  // hips. Parents come first.
  int parent;
};

inline constexpr int kHumanBoneCount = 55;
const std::array<HumanBone, kHumanBoneCount>& HumanBones();

// Its index, in upper or lower case; -1 for other names.
int FindHumanBone(absl::string_view name);

inline constexpr int kHipsBone = 0;

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_HUMAN_BONE_H_
