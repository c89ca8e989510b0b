#include "client/cli/vmc/human_bone.h"

#include "absl/strings/match.h"

namespace gelenk::cli {

const std::array<HumanBone, kHumanBoneCount>& HumanBones() {
  static constexpr std::array<HumanBone, kHumanBoneCount> kBones = {{
      {"Hips", -1},                     // 0
      {"LeftUpperLeg", 0},              // 1
      {"LeftLowerLeg", 1},              // 2
      {"LeftFoot", 2},                  // 3
      {"LeftToes", 3},                  // 4
      {"RightUpperLeg", 0},             // 5
      {"RightLowerLeg", 5},             // 6
      {"RightFoot", 6},                 // 7
      {"RightToes", 7},                 // 8
      {"Spine", 0},                     // 9
      {"Chest", 9},                     // 10
      {"UpperChest", 10},               // 11
      {"Neck", 11},                     // 12
      {"Head", 12},                     // 13
      {"LeftEye", 13},                  // 14
      {"RightEye", 13},                 // 15
      {"Jaw", 13},                      // 16
      {"LeftShoulder", 11},             // 17
      {"LeftUpperArm", 17},             // 18
      {"LeftLowerArm", 18},             // 19
      {"LeftHand", 19},                 // 20
      {"LeftThumbProximal", 20},        // 21
      {"LeftThumbIntermediate", 21},    // 22
      {"LeftThumbDistal", 22},          // 23
      {"LeftIndexProximal", 20},        // 24
      {"LeftIndexIntermediate", 24},    // 25
      {"LeftIndexDistal", 25},          // 26
      {"LeftMiddleProximal", 20},       // 27
      {"LeftMiddleIntermediate", 27},   // 28
      {"LeftMiddleDistal", 28},         // 29
      {"LeftRingProximal", 20},         // 30
      {"LeftRingIntermediate", 30},     // 31
      {"LeftRingDistal", 31},           // 32
      {"LeftLittleProximal", 20},       // 33
      {"LeftLittleIntermediate", 33},   // 34
      {"LeftLittleDistal", 34},         // 35
      {"RightShoulder", 11},            // 36
      {"RightUpperArm", 36},            // 37
      {"RightLowerArm", 37},            // 38
      {"RightHand", 38},                // 39
      {"RightThumbProximal", 39},       // 40
      {"RightThumbIntermediate", 40},   // 41
      {"RightThumbDistal", 41},         // 42
      {"RightIndexProximal", 39},       // 43
      {"RightIndexIntermediate", 43},   // 44
      {"RightIndexDistal", 44},         // 45
      {"RightMiddleProximal", 39},      // 46
      {"RightMiddleIntermediate", 46},  // 47
      {"RightMiddleDistal", 47},        // 48
      {"RightRingProximal", 39},        // 49
      {"RightRingIntermediate", 49},    // 50
      {"RightRingDistal", 50},          // 51
      {"RightLittleProximal", 39},      // 52
      {"RightLittleIntermediate", 52},  // 53
      {"RightLittleDistal", 53},        // 54
  }};
  return kBones;
}

int FindHumanBone(absl::string_view name) {
  for (int i = 0; i < kHumanBoneCount; ++i) {
    if (absl::EqualsIgnoreCase(name, HumanBones()[i].name)) return i;
  }
  return -1;
}

}  // namespace gelenk::cli
