#include "gelenk/import/gltf_skin_writer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "gelenk/import/gltf_file.h"
#include "gelenk/skin/linear_blend_export.h"

namespace gelenk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr int kInfluences = 4;
// A track that moves less is none: m, and parts of 1.
constexpr double kStill = 1e-7;

// What a node can hold of a bone's matrix.
struct NodeTransform {
  Vector3d translation;
  Eigen::Vector4d rotation;  // x y z w
  Vector3d scale;
};

NodeTransform NodeOf(const BoneMatrix& bone) {
  const Vector3d s = bone.col(1), t = bone.col(2);
  Matrix3d axes;
  axes.col(1) = s.stableNormalized();
  axes.col(0) = axes.col(1).cross(t).stableNormalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {bone.col(3), Eigen::Quaterniond(axes).normalized().coeffs(),
          Vector3d(1, s.norm(), t.norm())};
}

class SkinWriter {
 public:
  SkinWriter(const LayeredSkin& skin, absl::Span<const SkinKey> keys,
             double frame_time_s)
      : skin_(skin),
        keys_(keys),
        frame_time_s_(frame_time_s),
        blend_(ExportLinearBlend(skin)) {
    skin.rig().Evaluate(skin.rig().rest_positions(), {}, frame_);
    rest_ = BoneMatrices(skin.rig(), frame_);
    joint_of_.assign(blend_.bones.size(), -1);
    for (const LinearBlendExport::Vertex& vertex : blend_.vertices) {
      for (int k = 0; k < kInfluences; ++k) {
        if (vertex.weights[k] > 0) joint_of_[vertex.bones[k]] = 0;
      }
    }
    for (size_t bone = 0; bone < joint_of_.size(); ++bone) {
      if (joint_of_[bone] < 0) continue;
      joint_of_[bone] = static_cast<int>(used_.size());
      used_.push_back(static_cast<int>(bone));
    }
  }

  GltfSkinFile Write(GltfForm form) {
    file_.root["asset"] = {{"version", "2.0"}, {"generator", "gelenk"}};
    AddNodes();
    AddMesh();
    if (!keys_.empty()) AddAnimation();
    return {std::move(file_).Finish(form),
            static_cast<int>(blend_.inexact.size())};
  }

 private:
  // Node 0 is the root, node 1 the mesh, the joints follow.
  static constexpr int kFirstJointNode = 2;

  void AddNodes() {
    json nodes = json::array(
        {{{"name", "skin"}}, {{"name", "mesh"}, {"mesh", 0}, {"skin", 0}}});
    json children = json::array({1});
    json joints = json::array();
    for (int bone : used_) {
      const NodeTransform node = NodeOf(rest_[bone]);
      joints.push_back(nodes.size());
      children.push_back(nodes.size());
      nodes.push_back({{"name", blend_.bones[bone]},
                       {"translation", GltfNumbers(node.translation)},
                       {"rotation", GltfNumbers(node.rotation)},
                       {"scale", GltfNumbers(node.scale)}});
    }
    nodes[0]["children"] = std::move(children);
    file_.root["nodes"] = std::move(nodes);
    file_.root["skins"] =
        json::array({{{"joints", std::move(joints)}, {"skeleton", 0}}});
    file_.root["scenes"] = json::array({{{"nodes", json::array({0})}}});
    file_.root["scene"] = 0;
  }

  void AddMesh() {
    const int count = skin_.vertex_count();
    Eigen::MatrixXd positions(3, count), normals(3, count);
    Eigen::MatrixXd weights(kInfluences, count);
    Eigen::Matrix<uint16_t, kInfluences, Eigen::Dynamic> joints(kInfluences,
                                                                count);
    const std::vector<Vector3d> rest_normals = VertexNormals(skin_.mesh());
    for (int v = 0; v < count; ++v) {
      const LinearBlendExport::Vertex& vertex = blend_.vertices[v];
      positions.col(v) = vertex.position;
      Matrix3d blended = Matrix3d::Zero();
      for (int k = 0; k < kInfluences; ++k) {
        const bool counts = vertex.weights[k] > 0;
        weights(k, v) = vertex.weights[k];
        joints(k, v) =
            static_cast<uint16_t>(counts ? joint_of_[vertex.bones[k]] : 0);
        blended += vertex.weights[k] * rest_[vertex.bones[k]].leftCols<3>();
      }
      normals.col(v) = (blended.inverse() * rest_normals[v]).stableNormalized();
    }
    std::vector<uint32_t> indices;
    indices.reserve(3 * skin_.triangles().size());
    for (const Triangle& triangle : skin_.triangles()) {
      indices.insert(indices.end(), triangle.begin(), triangle.end());
    }
    json primitive = {
        {"attributes",
         {{"POSITION", file_.AddFloats(positions, /*with_range=*/true)},
          {"NORMAL", file_.AddFloats(normals)},
          {"JOINTS_0", file_.AddJoints(joints)},
          {"WEIGHTS_0", file_.AddFloats(weights)}}},
        {"indices", file_.AddIndices(indices)}};
    file_.root["meshes"] = json::array(
        {{{"name", "skin"}, {"primitives", json::array({primitive})}}});
  }

  void AddAnimation() {
    const auto count = static_cast<Eigen::Index>(keys_.size());
    const auto bones = static_cast<Eigen::Index>(used_.size());
    Eigen::MatrixXd translations(3 * bones, count), scales(3 * bones, count);
    Eigen::MatrixXd rotations(4 * bones, count);
    for (Eigen::Index i = 0; i < count; ++i) {
      skin_.rig().Evaluate(keys_[i].positions, keys_[i].world_from_skeleton,
                           frame_);
      const std::vector<BoneMatrix> matrices =
          BoneMatrices(skin_.rig(), frame_);
      for (Eigen::Index b = 0; b < bones; ++b) {
        const NodeTransform node = NodeOf(matrices[used_[b]]);
        translations.col(i).segment<3>(3 * b) = node.translation;
        scales.col(i).segment<3>(3 * b) = node.scale;
        auto rotation = rotations.col(i).segment<4>(4 * b);
        rotation = node.rotation;
        // On the shorter way from the key before.
        if (i > 0 && rotation.dot(rotations.col(i - 1).segment<4>(4 * b)) < 0) {
          rotation *= -1;
        }
      }
    }
    const int times = file_.AddFloats(
        frame_time_s_ * Eigen::RowVectorXd::LinSpaced(
                            count, 0, static_cast<double>(count - 1)),
        /*with_range=*/true);
    for (Eigen::Index b = 0; b < bones; ++b) {
      const int node = kFirstJointNode + static_cast<int>(b);
      const NodeTransform rest = NodeOf(rest_[used_[b]]);
      AddTrack(node, "translation", times, translations.middleRows(3 * b, 3),
               rest.translation);
      AddTrack(node, "rotation", times, rotations.middleRows(4 * b, 4),
               rest.rotation);
      AddTrack(node, "scale", times, scales.middleRows(3 * b, 3), rest.scale);
    }
    if (animation_["channels"].empty()) return;
    file_.root["animations"] = json::array({std::move(animation_)});
  }

  // Nothing where the node stays where it stands.
  void AddTrack(int node, const char* path, int times,
                const Eigen::MatrixXd& values, const Eigen::VectorXd& rest) {
    if ((values.colwise() - rest).cwiseAbs().maxCoeff() <= kStill) return;
    json& samplers = animation_["samplers"];
    animation_["channels"].push_back(
        {{"sampler", samplers.size()},
         {"target", {{"node", node}, {"path", path}}}});
    samplers.push_back({{"input", times}, {"output", file_.AddFloats(values)}});
  }

  const LayeredSkin& skin_;
  const absl::Span<const SkinKey> keys_;
  const double frame_time_s_;
  const LinearBlendExport blend_;
  VolumeFrame frame_;
  std::vector<BoneMatrix> rest_;
  std::vector<int> joint_of_;  // of each bone; -1 for one that moves nothing
  std::vector<int> used_;      // bones
  GltfFile file_;
  json animation_ = {{"channels", json::array()}, {"samplers", json::array()}};
};

}  // namespace

GltfSkinFile WriteGltfSkin(const LayeredSkin& skin,
                           absl::Span<const SkinKey> keys, double frame_time_s,
                           GltfForm form) {
  return SkinWriter(skin, keys, frame_time_s).Write(form);
}

}  // namespace gelenk
