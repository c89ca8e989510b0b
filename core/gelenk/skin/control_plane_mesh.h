// A skin on the side of a client that gets control planes only: where each
// vertex lies in the volumes, and how it moves with them.
//
//   mesh = ControlPlaneMesh::Create(layout)      once
//   mesh->Deform(bytes, positions, normals)      a frame of the stream
//
// Deforms in double precision, one vertex after the other: some 0.1 us each.
#ifndef GELENK_SKIN_CONTROL_PLANE_MESH_H_
#define GELENK_SKIN_CONTROL_PLANE_MESH_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/skin/control_plane_stream.h"
#include "gelenk/skin/layered_skin.h"

namespace gelenk {

// Packed as the contract's VolumeLayout, which says more.
struct ControlPlaneLayout {
  std::vector<PlaneLink> links;
  // Of each vertex its volume; u, s (m), t (m) in it; the normal at rest by
  // them.
  std::vector<int> vertex_volumes;
  std::vector<float> coordinates;
  std::vector<float> normal_components;
  // What branches have of vertices: which, by rising vertices, in what volume,
  // where, how much.
  std::vector<int> part_vertices;
  std::vector<int> part_volumes;
  std::vector<float> part_coordinates;
  std::vector<float> part_shares;
  // Along two tangents at rest: u, s, t of the part (3 and 3), its share (2),
  // and, once a vertex, u, s, t of its own volume (3 and 3).
  std::vector<float> part_slopes;
  std::vector<float> part_share_slopes;
  std::vector<float> own_slopes;
};

ControlPlaneLayout LayoutOf(const LayeredSkin& skin);

class ControlPlaneMesh {
 public:
  // INVALID_ARGUMENT listing what does not fit together.
  static absl::StatusOr<ControlPlaneMesh> Create(ControlPlaneLayout layout);

  int vertex_count() const {
    return static_cast<int>(layout_.vertex_volumes.size());
  }

  // A CONTROL_PLANES frame: vertices in order, world frame, m; unit normals.
  // INVALID_ARGUMENT for what is malformed or of another skin.
  absl::Status Deform(absl::string_view bytes,
                      std::vector<Eigen::Vector3d>& positions,
                      std::vector<Eigen::Vector3d>& normals);

 private:
  explicit ControlPlaneMesh(ControlPlaneLayout layout)
      : layout_(std::move(layout)) {}
  void DeformShared(int vertex, int first_part, int end_part, int shared,
                    Eigen::Vector3d& position, Eigen::Vector3d& normal) const;

  ControlPlaneLayout layout_;
  std::vector<BezierVolume> volumes_;  // of the newest frame
};

}  // namespace gelenk

#endif  // GELENK_SKIN_CONTROL_PLANE_MESH_H_
