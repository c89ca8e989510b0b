// Closed surfaces made from numbers: tubes, and skins around a skeleton's
// links.
#ifndef GELENK_SKIN_MESH_AROUND_H_
#define GELENK_SKIN_MESH_AROUND_H_

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

// A round tube along +X from the origin with flat ends, closed: `rings` + 1
// rings of `around` vertices, then the middles of the two ends.
struct TubeShape {
  double length_m = 1;
  double radius_m = 0.1;
  int rings = 40;
  int around = 24;
};
// INVALID_ARGUMENT that lists what is not > 0, or too much.
absl::StatusOr<TriangleMesh> TubeMesh(const TubeShape& shape);

// A round cone with round ends.
struct Capsule {
  Eigen::Vector3d start;
  Eigen::Vector3d end;
  double start_radius_m;
  double end_radius_m;
};

// The surface around the union of capsules, smooth over `blend_m` where they
// meet; closed, of quads cut in two with edges of about `cell_m`.
// INVALID_ARGUMENT when there is none, a number is malformed, or the grid would
// have more than kMaxGridCells.
// Cost: cells times capsules.
// Source: Gibson, "Constrained elastic surface nets", 1998, without the
// relaxation.
absl::StatusOr<TriangleMesh> MeshAround(absl::Span<const Capsule> capsules,
                                        double cell_m, double blend_m);
inline constexpr int kMaxGridCells = 1 << 24;

// Signed distance, m; negative inside.
double DistanceTo(const Capsule& capsule, const Eigen::Vector3d& point);

}  // namespace gelenk

#endif  // GELENK_SKIN_MESH_AROUND_H_
