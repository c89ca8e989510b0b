#include "gelenk/import/gltf_placement.h"

namespace gelenk {

std::vector<GltfPlacement> PlaceGltfNodes(const GltfDocument& document) {
  std::vector<GltfPlacement> placements(document.nodes.size());
  std::vector<int> waiting;
  for (size_t i = 0; i < document.nodes.size(); ++i) {
    if (document.nodes[i].parent < 0) waiting.push_back(static_cast<int>(i));
  }
  const GltfPlacement world;
  while (!waiting.empty()) {
    const int index = waiting.back();
    waiting.pop_back();
    const GltfNode& node = document.nodes[index];
    const GltfPlacement& parent =
        node.parent < 0 ? world : placements[node.parent];
    GltfPlacement& placement = placements[index];
    placement.position = parent.linear * node.translation + parent.position;
    placement.rotation = (parent.rotation * node.rotation).normalized();
    placement.linear = parent.linear * node.rotation.toRotationMatrix() *
                       node.scale.asDiagonal();
    waiting.insert(waiting.end(), node.children.begin(), node.children.end());
  }
  return placements;
}

}  // namespace gelenk
