#include "convert/skin_layout.h"

#include <vector>

#include "convert/skin_deformer.h"

namespace gelenk::convert {
namespace {

void AddNumbers(const Eigen::Vector3d& vector,
                google::protobuf::RepeatedField<float>* proto) {
  for (double number : vector) proto->Add(static_cast<float>(number));
}

void AddCoordinates(const VolumeCoordinates& at,
                    google::protobuf::RepeatedField<float>* proto) {
  AddNumbers({at.u, at.s, at.t}, proto);
}

}  // namespace

void ToProto(const Skin& skin, v1::SkinLayout* proto) {
  proto->set_block_count(skin.block_count());
  proto->mutable_slots()->Assign(skin.slots().begin(), skin.slots().end());
  proto->mutable_triangles()->Reserve(
      static_cast<int>(3 * skin.triangles().size()));
  for (const Triangle& triangle : skin.triangles()) {
    for (int vertex : triangle) proto->add_triangles(vertex);
  }
}

void ToProto(const LayeredSkin& skin, v1::VolumeLayout* proto) {
  const VolumeRig& rig = skin.rig();
  for (int i = 0; i < rig.link_count(); ++i) {
    convert::ToProto(rig, i, proto->add_links());
  }
  const SkinBinding& binding = skin.binding();
  const std::vector<Eigen::Vector3d> normals = VertexNormals(skin.mesh());
  for (int v = 0; v < skin.vertex_count(); ++v) {
    const VertexBinding& vertex = binding.vertices[v];
    proto->add_vertex_volumes(vertex.volume);
    AddCoordinates(vertex.at, proto->mutable_coordinates());
    const Eigen::Matrix3d jacobian =
        rig.rest().volume(vertex.volume).Evaluate(vertex.at).Jacobian();
    AddNumbers(jacobian.transpose() * normals[v],
               proto->mutable_normal_components());
    for (const BlendShare& part : binding.SharesOf(v)) {
      proto->add_part_vertices(v);
      proto->add_part_volumes(part.volume);
      AddCoordinates(part.at, proto->mutable_part_coordinates());
      proto->add_part_shares(static_cast<float>(part.share));
    }
  }
}

}  // namespace gelenk::convert
