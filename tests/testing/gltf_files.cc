#include "tests/testing/gltf_files.h"

#include "absl/strings/str_cat.h"

namespace gelenk::testing {

std::string LittleEndian(uint32_t number) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) {
    bytes.push_back(static_cast<char>(number >> 8 * i & 0xFF));
  }
  return bytes;
}

std::string Glb(absl::string_view json, absl::string_view bin) {
  std::string text(json);
  // Chunks end at multiples of four.
  while (text.size() % 4 != 0) text += ' ';
  std::string chunks = absl::StrCat(
      LittleEndian(static_cast<uint32_t>(text.size())), "JSON", text);
  if (!bin.empty()) {
    absl::StrAppend(&chunks, LittleEndian(static_cast<uint32_t>(bin.size())),
                    absl::string_view("BIN\0", 4), bin);
  }
  return absl::StrCat("glTF", LittleEndian(2),
                      LittleEndian(static_cast<uint32_t>(chunks.size()) + 12),
                      chunks);
}

std::string BodyGltf() {
  return R"({
  "asset": {"version": "2.0", "generator": "by hand"},
  "scene": 0,
  "scenes": [{"name": "Stage", "nodes": [0]}],
  "nodes": [
    {"name": "Armature", "children": [1, 7],
     "matrix": [0.01, 0, 0, 0,  0, 0, -0.01, 0,  0, 0.01, 0, 0,  0.5, 0, 0, 1]},
    {"name": "Hips", "children": [2], "translation": [0, 0, 95],
     "rotation": [0.7071067811865476, 0, 0, 0.7071067811865476]},
    {"name": "Spine", "children": [3, 4, 5], "translation": [0, 20, 1],
     "rotation": [0.1, 0, 0, 0.99498743710662]},
    {"name": "Head", "children": [6], "translation": [0, 35, 0]},
    {"name": "LeftHand", "translation": [60, 25, 0],
     "rotation": [0, 0, 0.6, 0.8]},
    {"name": "RightHand", "translation": [-60, 25, 0],
     "rotation": [0, 0, -0.6, 0.8]},
    {"name": "HeadTop", "translation": [0, 22, 0]},
    {"name": "Mesh", "mesh": 0, "skin": 0}
  ],
  "skins": [{"name": "Body", "joints": [1, 2, 3, 4, 5], "skeleton": 1,
             "inverseBindMatrices": 0}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 1}}]}],
  "buffers": [{"uri": "body.bin", "byteLength": 4096}],
  "images": [{"uri": "../../etc/passwd"}],
  "extensions": {"VRMC_vrm": {"humanoid": {"humanBones": {"hips": {"node": 1}}}}}
})";
}

}  // namespace gelenk::testing
