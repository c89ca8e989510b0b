#include "tests/core/import/gltf_skin_oracle.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "gelenk/math/rotation.h"
#include "tests/testing/matrix_kinematics_oracle.h"

namespace gelenk::testing {
namespace {

using Eigen::Matrix4d;
using Eigen::MatrixXd;
using nlohmann::json;

template <class T>
double As(const char* at) {
  T number;
  std::memcpy(&number, at, sizeof(number));
  return static_cast<double>(number);
}

int BytesOf(int component_type) {
  return component_type < 5122 ? 1 : component_type < 5125 ? 2 : 4;
}

int RowsOf(const std::string& type) {
  return type == "SCALAR" ? 1 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
}

}  // namespace

GltfSkinOracle::GltfSkinOracle(const std::string& bytes) : nodes_(bytes) {
  for (const json& buffer : nodes_.root()["buffers"]) {
    std::string& own = buffers_.emplace_back();
    if (buffer.contains("uri")) {
      const std::string uri = buffer["uri"];
      absl::Base64Unescape(uri.substr(uri.find(',') + 1), &own);
    } else {
      uint32_t json_size = 0;
      std::memcpy(&json_size, bytes.data() + 12, sizeof(json_size));
      own = bytes.substr(12 + 8 + json_size + 8);
    }
  }
}

double GltfSkinOracle::Number(const char* at, int component_type,
                              bool is_normalized) const {
  switch (component_type) {
    case 5121:
      return As<uint8_t>(at) / (is_normalized ? 255 : 1);
    case 5123:
      return As<uint16_t>(at) / (is_normalized ? 65535 : 1);
    case 5125:
      return As<uint32_t>(at);
    default:
      return As<float>(at);
  }
}

MatrixXd GltfSkinOracle::Read(const json& accessor_index) const {
  const json& root = nodes_.root();
  const json& accessor = root["accessors"][accessor_index.get<size_t>()];
  const int rows = RowsOf(accessor["type"]);
  const int type = accessor["componentType"];
  const bool is_normalized = accessor.value("normalized", false);
  MatrixXd values = MatrixXd::Zero(rows, accessor["count"].get<int>());
  const auto bytes_at = [&](const json& place, int stride_bytes, int i) {
    const json& view = root["bufferViews"][place["bufferView"].get<size_t>()];
    return buffers_[view["buffer"].get<size_t>()].data() +
           view.value("byteOffset", 0) + place.value("byteOffset", 0) +
           i * view.value("byteStride", stride_bytes);
  };
  const auto read_column = [&](const json& place, int from, Eigen::Index to) {
    const char* at = bytes_at(place, rows * BytesOf(type), from);
    for (int row = 0; row < rows; ++row) {
      values(row, to) = Number(at + row * BytesOf(type), type, is_normalized);
    }
  };
  if (accessor.contains("bufferView")) {
    for (int i = 0; i < values.cols(); ++i) read_column(accessor, i, i);
  }
  if (accessor.contains("sparse")) {
    const json& sparse = accessor["sparse"];
    for (int i = 0; i < sparse["count"].get<int>(); ++i) {
      const json& indices = sparse["indices"];
      const int index_type = indices["componentType"];
      const double index =
          Number(bytes_at(indices, BytesOf(index_type), i), index_type, false);
      read_column(sparse["values"], i, static_cast<Eigen::Index>(index));
    }
  }
  return values;
}

std::vector<Eigen::Vector3d> GltfSkinOracle::Positions(
    const std::map<int, Eigen::Matrix3d>& turns) const {
  const json& root = nodes_.root();
  std::vector<Eigen::Vector3d> positions;
  for (size_t n = 0; n < root["nodes"].size(); ++n) {
    const json& node = root["nodes"][n];
    if (!node.contains("mesh")) continue;
    std::vector<Matrix4d> scene_from_mesh;
    if (node.contains("skin")) {
      const json& skin = root["skins"][node["skin"].get<size_t>()];
      const MatrixXd inverse_binds = Read(skin["inverseBindMatrices"]);
      for (size_t k = 0; k < skin["joints"].size(); ++k) {
        const Eigen::VectorXd numbers =
            inverse_binds.col(static_cast<Eigen::Index>(k));
        scene_from_mesh.push_back(
            nodes_.SceneFromNode(skin["joints"][k], turns) *
            Eigen::Map<const Matrix4d>(numbers.data()));
      }
    } else {
      scene_from_mesh.push_back(
          nodes_.SceneFromNode(static_cast<int>(n), turns));
    }
    const json& mesh = root["meshes"][node["mesh"].get<size_t>()];
    for (const json& primitive : mesh["primitives"]) {
      const json& attributes = primitive["attributes"];
      const MatrixXd at = Read(attributes["POSITION"]);
      std::vector<MatrixXd> joints, weights;
      for (int set = 0; node.contains("skin") && set < 2; ++set) {
        const std::string name = absl::StrCat("JOINTS_", set);
        if (!attributes.contains(name)) continue;
        joints.push_back(Read(attributes[name]));
        weights.push_back(Read(attributes[absl::StrCat("WEIGHTS_", set)]));
      }
      for (Eigen::Index v = 0; v < at.cols(); ++v) {
        Matrix4d blended = Matrix4d::Zero();
        for (size_t set = 0; set < joints.size(); ++set) {
          for (int k = 0; k < 4; ++k) {
            // The index of an influence without weight may be any.
            if (weights[set](k, v) == 0) continue;
            blended += weights[set](k, v) *
                       scene_from_mesh[static_cast<int>(joints[set](k, v))];
          }
        }
        if (joints.empty()) blended = scene_from_mesh[0];
        // Of weights that do not sum to 1.
        blended /= blended(3, 3);
        positions.push_back((blended * at.col(v).homogeneous()).head<3>());
      }
    }
  }
  return positions;
}

double LargestError(const std::vector<Eigen::Vector3d>& positions,
                    const Skin& skin, const VertexBlocks& blocks) {
  if (skin.vertex_count() != static_cast<int>(positions.size())) {
    return std::numeric_limits<double>::infinity();
  }
  double error = 0;
  Eigen::AlignedBox3d box;
  for (size_t v = 0; v < positions.size(); ++v) {
    const Eigen::Vector3d got = blocks.position(skin.slots()[v]).cast<double>();
    error = std::max(error, (got - positions[v]).norm());
    box.extend(positions[v]);
  }
  return error / box.diagonal().norm();
}

TurnedPose RandomTurns(Random& random, const GltfImport& import,
                       double most_rad) {
  TurnedPose pose;
  pose.positions = import.skeleton->rest_positions();
  for (size_t node = 0; node < import.joint_of_node.size(); ++node) {
    const int joint = import.joint_of_node[node];
    if (joint < 0) continue;
    const Eigen::Vector3d turn(Uniform(random, -1, 1), Uniform(random, -1, 1),
                               Uniform(random, -1, 1));
    const Eigen::Quaterniond further = ExpRotation(most_rad / 2 * turn);
    double* const xyzw =
        pose.positions.data() + import.skeleton->span(joint).quaternion_offset;
    StoreXyzw(QuaternionXyzw(xyzw) * further, xyzw);
    pose.turns[static_cast<int>(node)] = further.toRotationMatrix();
  }
  return pose;
}

}  // namespace gelenk::testing
