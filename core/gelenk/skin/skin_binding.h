// Which volume each vertex of a mesh lies in, and how sure that is.
//
// A vertex is a candidate of every link whose volumes hold it (u in [0, 1],
// within the ellipse of the section); links of one chain count as one. With
// candidates of one chain only it is unique, with several ambiguous: then the
// labels of unique vertices flow along the edges of the mesh, by geodesic
// distance, into the ambiguous ones that they are candidates of. What the
// method is not sure of stays flagged for a person to decide (see rebind.h).
// Vertices at one place (see mesh_places.h) are one: they go together.
//
// Coordinates in the volumes give back the mesh exactly at the rest pose.
//
// Errors: INVALID_ARGUMENT that lists what is wrong with the mesh or with the
// assignments. Cost: some 3 us a vertex with 20 links, linear in the links.
#ifndef GELENK_SKIN_SKIN_BINDING_H_
#define GELENK_SKIN_SKIN_BINDING_H_

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/skin/triangle_mesh.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

enum class BindingClass {
  // One chain holds it; or none, but the surface leads to the one that is
  // clearly the nearest.
  kUnique,
  kAmbiguous,  // several do; see its candidates
  kOutside,    // none does: bound to the nearest
  kBlend,      // near a branch: in its stub, or its parent's, too
  kUser,       // as somebody decided
};
inline constexpr int kBindingClassCount = 5;

// "unique", "ambiguous", "outside", "blend", "user".
absl::string_view BindingClassName(BindingClass binding_class);

struct BindingCandidate {
  int link = -1;
  // Distance from the bone as a part of the section, 0 .. 1; four times that
  // when the surface faces the bone. The lower, the likelier.
  double score = 0;
};

// What a branch has of a vertex.
struct BlendShare {
  int volume = -1;
  VolumeCoordinates at;
  double share = 0;                                    // 0 .. 1
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // of share, 1/m, at rest
};

struct VertexBinding {
  BindingClass binding_class = BindingClass::kUnique;
  int link = -1;
  int volume = -1;
  VolumeCoordinates at;
  // In SkinBinding::shares; what they leave of 1 is of `volume`.
  int first_share = 0;
  int share_count = 0;
  // In SkinBinding::candidates, best first; of ambiguous vertices.
  int first_candidate = 0;
  int candidate_count = 0;
  // Of kOutside: from the surface of the nearest section, m.
  float outside_m = 0;
};

// How a link that was assigned is meant.
enum class AssignmentScope {
  // The chain that the link is part of: the vertex goes to the volume of the
  // chain that holds it.
  kChain,
  // The link itself, rigid beyond its ends.
  kLink,
};

struct VertexAssignment {
  int vertex = -1;
  std::string link_id;
  AssignmentScope scope = AssignmentScope::kChain;

  bool operator==(const VertexAssignment&) const = default;
};

struct SkinBinding {
  std::vector<VertexBinding> vertices;
  std::vector<BlendShare> shares;
  std::vector<BindingCandidate> candidates;
  // What people decided: survives binding again, and is what is exported.
  std::vector<VertexAssignment> assignments;

  absl::Span<const BlendShare> SharesOf(int vertex) const {
    return absl::MakeConstSpan(shares).subspan(vertices[vertex].first_share,
                                               vertices[vertex].share_count);
  }
  absl::Span<const BindingCandidate> CandidatesOf(int vertex) const {
    return absl::MakeConstSpan(candidates)
        .subspan(vertices[vertex].first_candidate,
                 vertices[vertex].candidate_count);
  }
};

// Binds `mesh`. Of two assignments of one vertex the later counts; those of a
// vertex hold for all at its place that have none of their own.
absl::StatusOr<SkinBinding> BindMesh(
    const VolumeRig& rig, const TriangleMesh& mesh,
    absl::Span<const VertexAssignment> assignments = {});

// An edge whose ends lie on links that are not neighbours: it stretches as they
// part.
struct StretchedEdge {
  int vertices[2];
  int links[2];
};

struct BindingReport {
  std::array<int, kBindingClassCount> class_counts = {};
  // Per link, then per class.
  std::vector<std::array<int, kBindingClassCount>> link_counts;
  // The first kMaxListedEdges of them.
  std::vector<StretchedEdge> stretched_edges;
  int stretched_edge_count = 0;
};
inline constexpr int kMaxListedEdges = 1000;

BindingReport ReportOf(const VolumeRig& rig, const TriangleMesh& mesh,
                       const SkinBinding& binding);

// The vertices of one class, rising.
std::vector<int> VerticesOf(const SkinBinding& binding,
                            BindingClass binding_class);

}  // namespace gelenk

#endif  // GELENK_SKIN_SKIN_BINDING_H_
