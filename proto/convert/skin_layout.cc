#include "convert/skin_layout.h"

#include <vector>

#include "convert/skin_deformer.h"

namespace gelenk::convert {
namespace {

template <class Number>
void Set(const std::vector<Number>& numbers,
         google::protobuf::RepeatedField<Number>* proto) {
  proto->Assign(numbers.begin(), numbers.end());
}

template <class Number>
std::vector<Number> Numbers(
    const google::protobuf::RepeatedField<Number>& proto) {
  return {proto.begin(), proto.end()};
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
  for (int i = 0; i < skin.rig().link_count(); ++i) {
    convert::ToProto(skin.rig(), i, proto->add_links());
  }
  const ControlPlaneLayout layout = LayoutOf(skin);
  Set(layout.vertex_volumes, proto->mutable_vertex_volumes());
  Set(layout.coordinates, proto->mutable_coordinates());
  Set(layout.normal_components, proto->mutable_normal_components());
  Set(layout.part_vertices, proto->mutable_part_vertices());
  Set(layout.part_volumes, proto->mutable_part_volumes());
  Set(layout.part_coordinates, proto->mutable_part_coordinates());
  Set(layout.part_shares, proto->mutable_part_shares());
  Set(layout.part_slopes, proto->mutable_part_slopes());
  Set(layout.part_share_slopes, proto->mutable_part_share_slopes());
  Set(layout.own_slopes, proto->mutable_own_slopes());
}

ControlPlaneLayout FromProto(const v1::VolumeLayout& proto) {
  ControlPlaneLayout layout;
  for (const v1::SkinLink& link : proto.links()) {
    layout.links.push_back({link.parent(), link.continuation(), link.length_m(),
                            link.start_spacing_m(), link.end_spacing_m(),
                            link.is_branch()});
  }
  layout.vertex_volumes = Numbers(proto.vertex_volumes());
  layout.coordinates = Numbers(proto.coordinates());
  layout.normal_components = Numbers(proto.normal_components());
  layout.part_vertices = Numbers(proto.part_vertices());
  layout.part_volumes = Numbers(proto.part_volumes());
  layout.part_coordinates = Numbers(proto.part_coordinates());
  layout.part_shares = Numbers(proto.part_shares());
  layout.part_slopes = Numbers(proto.part_slopes());
  layout.part_share_slopes = Numbers(proto.part_share_slopes());
  layout.own_slopes = Numbers(proto.own_slopes());
  return layout;
}

}  // namespace gelenk::convert
