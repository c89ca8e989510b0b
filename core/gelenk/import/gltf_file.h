// A glTF 2.0 file as it is written: its JSON, and one buffer behind it.
#ifndef GELENK_IMPORT_GLTF_FILE_H_
#define GELENK_IMPORT_GLTF_FILE_H_

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/import/gltf_form.h"

namespace gelenk {

// Vectors as the format has them.
nlohmann::json GltfNumbers(const Eigen::VectorXd& vector);

class GltfFile {
 public:
  // All but buffers and what the accessors need is the caller's to fill in.
  nlohmann::json root;

  // Each adds an accessor and returns its index. Of a column per element, of 1,
  // 3 or 4 numbers, in single precision; `with_range` adds min and max, as
  // positions and times want them.
  int AddFloats(const Eigen::MatrixXd& columns, bool with_range = false);
  // Indices of vertices.
  int AddIndices(absl::Span<const uint32_t> indices);
  // Four joints a vertex.
  int AddJoints(const Eigen::Matrix<uint16_t, 4, Eigen::Dynamic>& columns);

  // Ends the file; nothing may follow.
  std::string Finish(GltfForm form) &&;

 private:
  int AddAccessor(const void* bytes, size_t size, nlohmann::json accessor);

  std::string buffer_;
};

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_FILE_H_
