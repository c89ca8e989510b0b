// Surfaces, shaded: back faces are left out, the rest is painted from the back
// to the front.
#ifndef CLIENT_CLI_PICTURE_MESH_PICTURE_H_
#define CLIENT_CLI_PICTURE_MESH_PICTURE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk::cli {

struct MeshPanel {
  std::string caption;
  std::vector<Eigen::Vector3d> positions;  // world frame, m
};

struct MeshView {
  // Unit, not parallel.
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  Eigen::Vector3d toward_viewer = Eigen::Vector3d::UnitZ();
  int columns = 4;
};

// All panels at one scale, row by row. `triangles` are of each panel's
// positions.
std::string MeshPictureSvg(absl::string_view title,
                           absl::Span<const Triangle> triangles,
                           absl::Span<const MeshPanel> panels,
                           const MeshView& view);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_MESH_PICTURE_H_
