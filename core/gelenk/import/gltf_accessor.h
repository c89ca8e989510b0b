// Numbers out of the buffers of a glTF file.
#ifndef GELENK_IMPORT_GLTF_ACCESSOR_H_
#define GELENK_IMPORT_GLTF_ACCESSOR_H_

#include <Eigen/Core>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/import/gltf_animation.h"

namespace gelenk {

enum class GltfNumbers {
  // Floats, or integers that the accessor calls normalized: fractions.
  kReal,
  // Unsigned integers as they are: indices.
  kWhole,
};

// Reads accessors; opens each buffer once, when it is first wanted.
class GltfAccessors {
 public:
  // `root` has the members accessors, bufferViews and buffers; `binary` is the
  // second chunk of a GLB. All outlive this. At most `max_numbers` are given
  // out altogether.
  GltfAccessors(const nlohmann::json& root, absl::string_view binary,
                const OpenUri& open_uri, size_t max_numbers);

  // How many elements the accessor says that it has. Errors: INVALID_ARGUMENT
  // with the path, as below.
  absl::StatusOr<size_t> Count(size_t accessor) const;

  // One column an element of `rows` numbers: 1, 3, 4, or 16 of a matrix, column
  // by column.
  absl::StatusOr<Eigen::MatrixXd> Read(
      size_t accessor, int rows, GltfNumbers numbers = GltfNumbers::kReal);

 private:
  // Elements of `row_count` numbers of a component type, in a buffer view.
  struct Layout {
    size_t view = 0;
    size_t offset = 0;
    size_t count = 0;
    int rows = 0;
    int component_type = 0;
    GltfNumbers numbers = GltfNumbers::kReal;
    std::string path;
  };

  absl::StatusOr<absl::string_view> Buffer(size_t index);
  // Of `layout`: the bytes from its first element on, and the stride.
  absl::StatusOr<absl::string_view> Bytes(const Layout& layout, size_t& stride);
  absl::Status ReadDense(const Layout& layout, Eigen::MatrixXd& values);
  absl::Status ReadSparse(const nlohmann::json& sparse, const Layout& layout,
                          Eigen::MatrixXd& values);

  const nlohmann::json& root_;
  absl::string_view binary_;
  const OpenUri& open_uri_;
  size_t numbers_left_;
  std::vector<std::optional<std::string>> opened_;
};

// The member `key` of `object` as a whole number >= 0, or `fallback` where it
// is missing. `path` is that of the object.
absl::StatusOr<size_t> ReadWhole(const nlohmann::json& object, const char* key,
                                 absl::string_view path,
                                 std::optional<size_t> fallback);

// Element `index` of the array `name` at the top of a file, an object.
absl::StatusOr<const nlohmann::json*> ObjectAt(const nlohmann::json& root,
                                               const char* name, size_t index);

}  // namespace gelenk

#endif  // GELENK_IMPORT_GLTF_ACCESSOR_H_
