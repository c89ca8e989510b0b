// glTF files, for everything that takes them.
#ifndef GELENK_TESTS_TESTING_GLTF_FILES_H_
#define GELENK_TESTS_TESTING_GLTF_FILES_H_

#include <cstdint>
#include <string>

#include "absl/strings/string_view.h"

namespace gelenk::testing {

// `json` in a GLB, followed by a chunk of `bin` where that is not empty.
std::string Glb(absl::string_view json, absl::string_view bin = "");

// Four bytes, the lowest first.
std::string LittleEndian(uint32_t number);

// A waving body: skin "Body" with joints "Hips" (below an armature that turns
// Z to Y and scales by 0.01), "Spine", "Head", "LeftHand", "RightHand"; a node
// "HeadTop" below the head; a skinned mesh; buffers in another file.
std::string BodyGltf();

inline constexpr int kBodyGltfJointCount = 5;

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_GLTF_FILES_H_
