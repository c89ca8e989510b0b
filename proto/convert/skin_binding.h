// Bindings, and what people decide about them, between the contract and the
// core.
#ifndef GELENK_CONVERT_SKIN_BINDING_H_
#define GELENK_CONVERT_SKIN_BINDING_H_

#include <google/protobuf/repeated_ptr_field.h>

#include <array>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/rebind.h"
#include "gelenk/skin/skin_binding.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::convert {

void ToProto(const std::array<int, kBindingClassCount>& counts,
             v1::BindingCounts* proto);

// What of a binding is asked for, besides its counts.
struct BindingDetail {
  bool classes = false;
  bool candidates = false;
  bool vertex_links = false;
};
// All but the name.
void ToProto(const LayeredSkin& skin, const BindingDetail& detail,
             v1::Binding* proto);

using AssignmentList = google::protobuf::RepeatedPtrField<v1::VertexAssignment>;

// One a vertex. INVALID_ARGUMENT for malformed runs, ids and scopes, and for
// more assignments than the mesh has vertices; whether the links exist is
// BindMesh's to say.
absl::StatusOr<std::vector<VertexAssignment>> FromProto(
    const AssignmentList& proto, int vertex_count);
// Runs of the same link and scope together.
void ToProto(const std::vector<VertexAssignment>& assignments,
             AssignmentList* proto);

// INVALID_ARGUMENT for a number that names no scope.
absl::StatusOr<AssignmentScope> FromProto(v1::AssignmentScope proto);

// INVALID_ARGUMENT when there is none, or for malformed runs; the rest is
// unchecked: SelectVertices does.
absl::StatusOr<VertexSelector> FromProto(const v1::VertexSelector& proto,
                                         int vertex_count);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_SKIN_BINDING_H_
