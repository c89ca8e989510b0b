#include "gelenk/import/gltf_accessor.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk {
namespace {

using nlohmann::json;

// Whole numbers of a file, all of which a double holds exactly.
constexpr double kMaxWhole = 1e15;

absl::Status Fault(absl::string_view path, absl::string_view reason) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", reason));
}

// 0 for what is none. glTF 2.0, "Accessor Data Types".
size_t ComponentBytes(int type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T Load(const char* bytes) {
  static_assert(std::endian::native == std::endian::little,
                "glTF's numbers have their lowest byte first");
  T number;
  std::memcpy(&number, bytes, sizeof(number));
  return number;
}

// Integers as the fractions they stand for: glTF 2.0, "Animations".
double ReadComponent(int type, const char* bytes) {
  switch (type) {
    case 5120:
      return std::max(Load<int8_t>(bytes) / 127.0, -1.0);
    case 5121:
      return Load<uint8_t>(bytes) / 255.0;
    case 5122:
      return std::max(Load<int16_t>(bytes) / 32767.0, -1.0);
    case 5123:
      return Load<uint16_t>(bytes) / 65535.0;
    default:
      return Load<float>(bytes);
  }
}

size_t ReadIndex(int type, const char* bytes) {
  switch (type) {
    case 5121:
      return Load<uint8_t>(bytes);
    case 5123:
      return Load<uint16_t>(bytes);
    default:
      return Load<uint32_t>(bytes);
  }
}

const char* TypeOfRows(int rows) {
  return rows == 1   ? "SCALAR"
         : rows == 3 ? "VEC3"
         : rows == 4 ? "VEC4"
                     : "MAT4";
}

// What keeps `type` from being read as `numbers`; empty for nothing.
std::string FaultOfType(size_t type, bool is_normalized, GltfNumbers numbers) {
  if (numbers == GltfNumbers::kWhole) {
    if (!is_normalized && (type == 5121 || type == 5123 || type == 5125)) {
      return "";
    }
    return absl::StrFormat("want 5121, 5123 or 5125, not normalized, got %d",
                           type);
  }
  if (type == 5126 || (is_normalized && type < 5125 &&
                       ComponentBytes(static_cast<int>(type)) > 0)) {
    return "";
  }
  return absl::StrFormat(
      "want 5126, or normalized integers of one or two bytes, got %d", type);
}

}  // namespace

absl::StatusOr<size_t> ReadWhole(const json& object, const char* key,
                                 absl::string_view path,
                                 std::optional<size_t> fallback) {
  const auto found = object.find(key);
  if (found == object.end()) {
    if (fallback) return *fallback;
    return Fault(absl::StrCat(path, ".", key), "missing");
  }
  if (found->is_number()) {
    // Some writers have all numbers with a point.
    const double number = found->get<double>();
    if (number >= 0 && number <= kMaxWhole && number == std::floor(number)) {
      return static_cast<size_t>(number);
    }
  }
  return Fault(absl::StrCat(path, ".", key), "want a whole number >= 0");
}

absl::StatusOr<const json*> ObjectAt(const json& root, const char* name,
                                     size_t index) {
  const auto found = root.find(name);
  if (found == root.end() || !found->is_array() || index >= found->size()) {
    return Fault(
        absl::StrCat(name, "[", index, "]"),
        absl::StrCat("there are ", found == root.end() || !found->is_array()
                                       ? 0
                                       : found->size()));
  }
  if (!(*found)[index].is_object()) {
    return Fault(absl::StrCat(name, "[", index, "]"), "want an object");
  }
  return &(*found)[index];
}

GltfAccessors::GltfAccessors(const json& root, absl::string_view binary,
                             const OpenUri& open_uri, size_t max_numbers)
    : root_(root),
      binary_(binary),
      open_uri_(open_uri),
      numbers_left_(max_numbers) {}

absl::StatusOr<absl::string_view> GltfAccessors::Buffer(size_t index) {
  const absl::StatusOr<const json*> buffer = ObjectAt(root_, "buffers", index);
  if (!buffer.ok()) return buffer.status();
  const std::string path = absl::StrCat("buffers[", index, "]");
  const auto uri = (*buffer)->find("uri");
  if (uri == (*buffer)->end()) {
    if (index == 0 && !binary_.empty()) return binary_;
    return Fault(path, "has neither a uri nor a chunk of a GLB");
  }
  if (opened_.size() <= index) opened_.resize(index + 1);
  if (opened_[index]) return absl::string_view(*opened_[index]);
  if (!uri->is_string()) return Fault(path + ".uri", "want a string");
  const auto& text = uri->get_ref<const std::string&>();
  std::string bytes;
  if (absl::StartsWith(text, "data:")) {
    constexpr absl::string_view kMark = ";base64,";
    const size_t at = absl::string_view(text).find(kMark);
    if (at == absl::string_view::npos ||
        !absl::Base64Unescape(absl::string_view(text).substr(at + kMark.size()),
                              &bytes)) {
      return Fault(path + ".uri", "no data in base64");
    }
  } else if (open_uri_ == nullptr) {
    return Fault(path + ".uri",
                 absl::StrCat("is in another file, ", QuotedId(text)));
  } else {
    absl::StatusOr<std::string> opened = open_uri_(text);
    if (!opened.ok()) {
      return Fault(path + ".uri", opened.status().message());
    }
    bytes = *std::move(opened);
  }
  opened_[index] = std::move(bytes);
  return absl::string_view(*opened_[index]);
}

absl::StatusOr<absl::string_view> GltfAccessors::Bytes(const Layout& layout,
                                                       size_t& stride) {
  const absl::StatusOr<const json*> view =
      ObjectAt(root_, "bufferViews", layout.view);
  if (!view.ok()) return view.status();
  const std::string path = absl::StrCat("bufferViews[", layout.view, "]");
  const auto buffer_index = ReadWhole(**view, "buffer", path, std::nullopt);
  const auto offset = ReadWhole(**view, "byteOffset", path, 0);
  const auto length = ReadWhole(**view, "byteLength", path, std::nullopt);
  const size_t element = ComponentBytes(layout.component_type) * layout.rows;
  const auto given_stride = ReadWhole(**view, "byteStride", path, element);
  for (const auto* number : {&buffer_index, &offset, &length, &given_stride}) {
    if (!number->ok()) return number->status();
  }
  const absl::StatusOr<absl::string_view> buffer = Buffer(*buffer_index);
  if (!buffer.ok()) return buffer.status();
  if (*offset > buffer->size() || *length > buffer->size() - *offset) {
    return Fault(
        path, absl::StrFormat("bytes %d to %d of a buffer that has %d", *offset,
                              *offset + *length, buffer->size()));
  }
  stride = *given_stride;
  if (stride < element) {
    return Fault(path + ".byteStride",
                 absl::StrFormat("want at least %d, got %d", element, stride));
  }
  // In numbers that cannot overflow: count and stride are below 1e15 each.
  const double end =
      static_cast<double>(layout.offset) +
      static_cast<double>(stride) * static_cast<double>(layout.count - 1) +
      static_cast<double>(element);
  if (end > static_cast<double>(*length)) {
    return Fault(layout.path,
                 absl::StrFormat("%d elements end at byte %.0f of bufferViews"
                                 "[%d], which has %d",
                                 layout.count, end, layout.view, *length));
  }
  return buffer->substr(*offset + layout.offset, *length - layout.offset);
}

absl::Status GltfAccessors::ReadDense(const Layout& layout,
                                      Eigen::MatrixXd& values) {
  size_t stride = 0;
  const absl::StatusOr<absl::string_view> bytes = Bytes(layout, stride);
  if (!bytes.ok()) return bytes.status();
  const size_t size = ComponentBytes(layout.component_type);
  for (size_t i = 0; i < layout.count; ++i) {
    for (int row = 0; row < layout.rows; ++row) {
      const char* at = bytes->data() + i * stride + row * size;
      values(row, static_cast<Eigen::Index>(i)) =
          layout.numbers == GltfNumbers::kWhole
              ? static_cast<double>(ReadIndex(layout.component_type, at))
              : ReadComponent(layout.component_type, at);
    }
  }
  return absl::OkStatus();
}

absl::Status GltfAccessors::ReadSparse(const json& sparse, const Layout& layout,
                                       Eigen::MatrixXd& values) {
  const std::string path = absl::StrCat(layout.path, ".sparse");
  if (!sparse.is_object() || !sparse.contains("indices") ||
      !sparse["indices"].is_object() || !sparse.contains("values") ||
      !sparse["values"].is_object()) {
    return Fault(path, "want objects indices and values");
  }
  const auto count = ReadWhole(sparse, "count", path, std::nullopt);
  if (!count.ok()) return count.status();
  if (*count < 1 || *count > layout.count) {
    return Fault(path + ".count",
                 absl::StrFormat("want 1 to %d, got %d", layout.count, *count));
  }
  const auto layout_of = [&](const char* key,
                             int rows) -> absl::StatusOr<Layout> {
    const json& object = sparse[key];
    Layout part = layout;
    part.path = absl::StrCat(path, ".", key);
    part.count = *count;
    part.rows = rows;
    const auto view = ReadWhole(object, "bufferView", part.path, std::nullopt);
    const auto offset = ReadWhole(object, "byteOffset", part.path, 0);
    const auto type =
        ReadWhole(object, "componentType", part.path, part.component_type);
    for (const auto* number : {&view, &offset, &type}) {
      if (!number->ok()) return number->status();
    }
    part.view = *view;
    part.offset = *offset;
    part.component_type = static_cast<int>(std::min<size_t>(*type, 9999));
    return part;
  };
  const absl::StatusOr<Layout> index_layout = layout_of("indices", 1);
  if (!index_layout.ok()) return index_layout.status();
  const int index_type = index_layout->component_type;
  if (index_type != 5121 && index_type != 5123 && index_type != 5125) {
    return Fault(index_layout->path + ".componentType",
                 absl::StrCat("want 5121, 5123 or 5125, got ", index_type));
  }
  absl::StatusOr<Layout> value_layout = layout_of("values", layout.rows);
  if (!value_layout.ok()) return value_layout.status();
  value_layout->component_type = layout.component_type;
  Eigen::MatrixXd replaced(layout.rows, static_cast<Eigen::Index>(*count));
  const absl::Status status = ReadDense(*value_layout, replaced);
  if (!status.ok()) return status;
  size_t stride = 0;
  const absl::StatusOr<absl::string_view> indices =
      Bytes(*index_layout, stride);
  if (!indices.ok()) return indices.status();
  for (size_t i = 0; i < *count; ++i) {
    const size_t index = ReadIndex(index_type, indices->data() + i * stride);
    if (index >= layout.count) {
      return Fault(
          absl::StrCat(index_layout->path, "[", i, "]"),
          absl::StrFormat("want 0 to %d, got %d", layout.count - 1, index));
    }
    values.col(static_cast<Eigen::Index>(index)) =
        replaced.col(static_cast<Eigen::Index>(i));
  }
  return absl::OkStatus();
}

absl::StatusOr<size_t> GltfAccessors::Count(size_t accessor) const {
  const absl::StatusOr<const json*> object =
      ObjectAt(root_, "accessors", accessor);
  if (!object.ok()) return object.status();
  return ReadWhole(**object, "count", absl::StrCat("accessors[", accessor, "]"),
                   std::nullopt);
}

absl::StatusOr<Eigen::MatrixXd> GltfAccessors::Read(size_t accessor, int rows,
                                                    GltfNumbers numbers) {
  const absl::StatusOr<const json*> object =
      ObjectAt(root_, "accessors", accessor);
  if (!object.ok()) return object.status();
  Layout layout;
  layout.path = absl::StrCat("accessors[", accessor, "]");
  layout.rows = rows;
  const auto count = ReadWhole(**object, "count", layout.path, std::nullopt);
  const auto type =
      ReadWhole(**object, "componentType", layout.path, std::nullopt);
  const auto offset = ReadWhole(**object, "byteOffset", layout.path, 0);
  const auto view = ReadWhole(**object, "bufferView", layout.path, SIZE_MAX);
  for (const auto* number : {&count, &type, &offset, &view}) {
    if (!number->ok()) return number->status();
  }
  const auto shape = (*object)->find("type");
  if (shape == (*object)->end() || *shape != TypeOfRows(rows)) {
    return Fault(layout.path + ".type",
                 absl::StrCat("want ", TypeOfRows(rows)));
  }
  const auto normalized = (*object)->find("normalized");
  const std::string fault = FaultOfType(
      *type, normalized != (*object)->end() && *normalized == true, numbers);
  if (!fault.empty()) return Fault(layout.path + ".componentType", fault);
  if (*count < 1 || *count > numbers_left_ / rows) {
    return Fault(
        layout.path + ".count",
        absl::StrFormat("want 1 to %d, got %d", numbers_left_ / rows, *count));
  }
  numbers_left_ -= *count * rows;
  layout.count = *count;
  layout.component_type = static_cast<int>(*type);
  layout.numbers = numbers;
  layout.offset = *offset;
  layout.view = *view;
  Eigen::MatrixXd values =
      Eigen::MatrixXd::Zero(rows, static_cast<Eigen::Index>(*count));
  const auto sparse = (*object)->find("sparse");
  if (*view != SIZE_MAX) {
    const absl::Status status = ReadDense(layout, values);
    if (!status.ok()) return status;
  } else if (sparse == (*object)->end()) {
    return Fault(layout.path, "has neither a bufferView nor sparse values");
  }
  if (sparse != (*object)->end()) {
    const absl::Status status = ReadSparse(*sparse, layout, values);
    if (!status.ok()) return status;
  }
  return values;
}

}  // namespace gelenk
