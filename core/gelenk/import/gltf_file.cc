#include "gelenk/import/gltf_file.h"

#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace gelenk {
namespace {

using nlohmann::json;

constexpr int kUnsignedShort = 5123;
constexpr int kUnsignedInt = 5125;
constexpr int kFloat = 5126;
// Chunks of a GLB and accessors begin at multiples of this.
constexpr size_t kAlignment = 4;

void AppendLittleEndian(uint32_t number, std::string& bytes) {
  for (int i = 0; i < 4; ++i) {
    bytes.push_back(static_cast<char>(number >> (8 * i) & 0xff));
  }
}

}  // namespace

json GltfNumbers(const Eigen::VectorXd& vector) {
  json array = json::array();
  for (double number : vector) array.push_back(number);
  return array;
}

int GltfFile::AddAccessor(const void* bytes, size_t size, json accessor) {
  accessor["bufferView"] = root["bufferViews"].size();
  root["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", size}});
  root["accessors"].push_back(std::move(accessor));
  buffer_.append(static_cast<const char*>(bytes), size);
  buffer_.resize((buffer_.size() + kAlignment - 1) / kAlignment * kAlignment);
  return static_cast<int>(root["accessors"].size()) - 1;
}

int GltfFile::AddFloats(const Eigen::MatrixXd& columns, bool with_range) {
  const char* const types[] = {"", "SCALAR", "", "VEC3", "VEC4"};
  const Eigen::MatrixXf singles = columns.cast<float>();
  json accessor = {{"componentType", kFloat},
                   {"count", singles.cols()},
                   {"type", types[singles.rows()]}};
  if (with_range) {
    accessor["min"] = GltfNumbers(singles.rowwise().minCoeff().cast<double>());
    accessor["max"] = GltfNumbers(singles.rowwise().maxCoeff().cast<double>());
  }
  return AddAccessor(singles.data(), singles.size() * sizeof(float),
                     std::move(accessor));
}

int GltfFile::AddIndices(absl::Span<const uint32_t> indices) {
  return AddAccessor(indices.data(), indices.size() * sizeof(uint32_t),
                     {{"componentType", kUnsignedInt},
                      {"count", indices.size()},
                      {"type", "SCALAR"}});
}

int GltfFile::AddJoints(
    const Eigen::Matrix<uint16_t, 4, Eigen::Dynamic>& columns) {
  return AddAccessor(columns.data(), columns.size() * sizeof(uint16_t),
                     {{"componentType", kUnsignedShort},
                      {"count", columns.cols()},
                      {"type", "VEC4"}});
}

std::string GltfFile::Finish(GltfForm form) && {
  const bool is_binary = form == GltfForm::kBinary;
  if (!buffer_.empty()) {
    json buffer = {{"byteLength", buffer_.size()}};
    if (!is_binary) {
      buffer["uri"] = absl::StrCat("data:application/octet-stream;base64,",
                                   absl::Base64Escape(buffer_));
    }
    root["buffers"] = json::array({std::move(buffer)});
  }
  // Names that are no UTF-8 must not throw.
  std::string text =
      root.dump(is_binary ? -1 : 1, ' ', false, json::error_handler_t::replace);
  if (!is_binary) return text + "\n";
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  std::string bytes = "glTF";
  AppendLittleEndian(2, bytes);
  const size_t binary_size = buffer_.empty() ? 0 : 8 + buffer_.size();
  AppendLittleEndian(static_cast<uint32_t>(20 + text.size() + binary_size),
                     bytes);
  AppendLittleEndian(static_cast<uint32_t>(text.size()), bytes);
  bytes += "JSON";
  bytes += text;
  if (!buffer_.empty()) {
    AppendLittleEndian(static_cast<uint32_t>(buffer_.size()), bytes);
    bytes.append("BIN\0", 4);
    bytes += buffer_;
  }
  return bytes;
}

}  // namespace gelenk
