// The two forms of a glTF file.
#ifndef GELENK_IMPORT_GLTF_FORM_H_
#define GELENK_IMPORT_GLTF_FORM_H_

namespace gelenk {

enum class GltfForm {
  kJson,    // .gltf, the buffer embedded in base64
  kBinary,  // .glb
};

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_FORM_H_
