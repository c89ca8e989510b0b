// Surfaces of skins between the contract and the core.
#ifndef GELENK_CONVERT_SKIN_SURFACE_H_
#define GELENK_CONVERT_SKIN_SURFACE_H_

#include "absl/status/statusor.h"
#include "gelenk/skin/nurbs_surface.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT for arrays of a length that does not fit, and as CheckMesh.
absl::StatusOr<TriangleMesh> FromProto(const v1::TriangleMesh& proto,
                                       const MeshBounds& bounds = {});
// In single precision.
void ToProto(const TriangleMesh& mesh, v1::TriangleMesh* proto);

// INVALID_ARGUMENT for arrays of a length that does not fit; else unchecked:
// NurbsSkin does.
absl::StatusOr<NurbsSurface> FromProto(const v1::NurbsSurface& proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_SKIN_SURFACE_H_
