// Vertices of a mesh that are at one place: where exporters cut a surface for
// texture seams and hard edges, or write triangles that share nothing. They are
// one for what the surface hangs together by; each keeps its own attributes.
#ifndef GELENK_SKIN_MESH_PLACES_H_
#define GELENK_SKIN_MESH_PLACES_H_

#include <Eigen/Core>
#include <vector>

#include "absl/types/span.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

// Vertices this part of the mesh's diagonal apart are at one place: about what
// single precision leaves of a coordinate after a few operations.
inline constexpr double kPlaceTolerance = 1e-6;

// For each vertex the first one at its place; itself for that one.
// Cost: linear, whatever the positions.
std::vector<int> FindPlaces(absl::Span<const Eigen::Vector3d> positions);

// The edges between places: those of the first vertex of each, none of others.
MeshEdges FindEdgesOfPlaces(absl::Span<const Triangle> triangles,
                            absl::Span<const int> places);

// The number of each vertex' connected component, from 0 in the order of their
// first vertices; what is at one place is connected.
std::vector<int> FindComponentsOfPlaces(absl::Span<const Triangle> triangles,
                                        absl::Span<const int> places);

}  // namespace gelenk

#endif  // GELENK_SKIN_MESH_PLACES_H_
