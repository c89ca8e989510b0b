// Buffers of glTF files, put together number by number.
#ifndef GELENK_TESTS_CORE_IMPORT_GLTF_BUFFER_H_
#define GELENK_TESTS_CORE_IMPORT_GLTF_BUFFER_H_

#include <string>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace gelenk::testing {

template <class T>
std::string Bytes(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()),
          numbers.size() * sizeof(T)};
}

struct GltfBuffer {
  std::string buffer;
  std::string view_list;
  std::string accessors;
  int views = 0;
  int accessor_count = 0;

  int AddView(const std::string& bytes) {
    absl::StrAppend(&view_list, views > 0 ? "," : "",
                    "{\"buffer\":0,\"byteOffset\":", buffer.size(),
                    ",\"byteLength\":", bytes.size(), "}");
    buffer += bytes;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    return views++;
  }

  int AddAccessor(const std::string& text) {
    absl::StrAppend(&accessors, accessors.empty() ? "" : ",", "{", text, "}");
    return accessor_count++;
  }

  // Of a view of its own. `type` is that of an element, as "VEC3".
  template <class T>
  int AddNumbers(const std::vector<T>& numbers, int component_type,
                 const char* type, size_t count, const std::string& more = "") {
    const int view = AddView(Bytes(numbers));
    return AddAccessor(absl::StrCat(
        "\"bufferView\":", view, ",\"componentType\":", component_type,
        ",\"count\":", count, ",\"type\":\"", type, "\"", more));
  }

  // "accessors", "bufferViews" and "buffers", the bytes embedded.
  std::string Members() const {
    return Members(absl::StrCat("{\"byteLength\":", buffer.size(), ",\"uri\":",
                                "\"data:application/octet-stream;base64,",
                                absl::Base64Escape(buffer), "\"}"));
  }
  // The same with another buffer.
  std::string Members(const std::string& buffer_json) const {
    return absl::StrCat("\"accessors\":[", accessors, "],\"bufferViews\":[",
                        view_list, "],\"buffers\":[", buffer_json, "]");
  }
};

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_IMPORT_GLTF_BUFFER_H_
