#include "convert/skin_binding.h"

#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/geometry.h"
#include "convert/vertex_runs.h"
#include "gelenk/base/violations.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::convert {
namespace {

v1::BindingClass ToProto(BindingClass binding_class) {
  switch (binding_class) {
    case BindingClass::kUnique:
      return v1::BINDING_CLASS_UNIQUE;
    case BindingClass::kAmbiguous:
      return v1::BINDING_CLASS_AMBIGUOUS;
    case BindingClass::kOutside:
      return v1::BINDING_CLASS_OUTSIDE;
    case BindingClass::kBlend:
      return v1::BINDING_CLASS_BLEND;
    case BindingClass::kUser:
      return v1::BINDING_CLASS_USER;
  }
  return v1::BINDING_CLASS_UNSPECIFIED;
}

v1::AssignmentScope ToProto(AssignmentScope scope) {
  return scope == AssignmentScope::kLink ? v1::ASSIGNMENT_SCOPE_LINK
                                         : v1::ASSIGNMENT_SCOPE_CHAIN;
}

void AddClasses(const SkinBinding& binding, v1::Binding* proto) {
  for (int k = 0; k < kBindingClassCount; ++k) {
    const auto binding_class = static_cast<BindingClass>(k);
    const std::vector<int> vertices = VerticesOf(binding, binding_class);
    if (vertices.empty()) continue;
    v1::Binding::Class* out = proto->add_classes();
    out->set_binding_class(ToProto(binding_class));
    convert::ToProto(vertices, out->mutable_vertices());
  }
}

void AddCandidates(const SkinBinding& binding, v1::Binding* proto) {
  for (size_t v = 0; v < binding.vertices.size(); ++v) {
    const int vertex = static_cast<int>(v);
    const VertexBinding& bound = binding.vertices[v];
    if (bound.binding_class == BindingClass::kAmbiguous) {
      v1::Binding::Ambiguous* out = proto->add_ambiguous();
      out->set_vertex(vertex);
      out->set_bound_link(bound.link);
      for (const BindingCandidate& candidate : binding.CandidatesOf(vertex)) {
        out->add_links(candidate.link);
        out->add_scores(static_cast<float>(candidate.score));
      }
    } else if (bound.binding_class == BindingClass::kOutside) {
      v1::Binding::Outside* out = proto->add_outside();
      out->set_vertex(vertex);
      out->set_bound_link(bound.link);
      out->set_distance_m(bound.outside_m);
    }
  }
}

void AddReport(const VolumeRig& rig, const BindingReport& report,
               v1::Binding* proto) {
  convert::ToProto(report.class_counts, proto->mutable_counts());
  for (int i = 0; i < rig.link_count(); ++i) {
    v1::Binding::Link* out = proto->add_links();
    out->set_link_id(rig.link(i).id);
    convert::ToProto(report.link_counts[i], out->mutable_counts());
  }
  for (const StretchedEdge& edge : report.stretched_edges) {
    v1::Binding::StretchedEdge* out = proto->add_stretched_edges();
    out->set_first_vertex(edge.vertices[0]);
    out->set_second_vertex(edge.vertices[1]);
    out->set_first_link(edge.links[0]);
    out->set_second_link(edge.links[1]);
  }
  proto->set_stretched_edge_count(report.stretched_edge_count);
}

}  // namespace

void ToProto(const std::array<int, kBindingClassCount>& counts,
             v1::BindingCounts* proto) {
  const auto count = [&counts](BindingClass binding_class) {
    return counts[static_cast<int>(binding_class)];
  };
  proto->set_unique_count(count(BindingClass::kUnique));
  proto->set_ambiguous_count(count(BindingClass::kAmbiguous));
  proto->set_outside_count(count(BindingClass::kOutside));
  proto->set_blend_count(count(BindingClass::kBlend));
  proto->set_user_count(count(BindingClass::kUser));
}

void ToProto(const LayeredSkin& skin, const BindingDetail& detail,
             v1::Binding* proto) {
  const SkinBinding& binding = skin.binding();
  AddReport(skin.rig(), ReportOf(skin.rig(), skin.mesh(), binding), proto);
  if (detail.classes) AddClasses(binding, proto);
  if (detail.candidates) AddCandidates(binding, proto);
  if (detail.vertex_links) {
    for (const VertexBinding& vertex : binding.vertices) {
      proto->add_vertex_links(vertex.link);
    }
  }
  ToProto(binding.assignments, proto->mutable_assignments());
}

absl::StatusOr<AssignmentScope> FromProto(v1::AssignmentScope proto) {
  switch (proto) {
    case v1::ASSIGNMENT_SCOPE_UNSPECIFIED:
    case v1::ASSIGNMENT_SCOPE_CHAIN:
      return AssignmentScope::kChain;
    case v1::ASSIGNMENT_SCOPE_LINK:
      return AssignmentScope::kLink;
    default:
      break;
  }
  Violations violations;
  violations.Add("scope",
                 absl::StrCat("no such scope: ", static_cast<int>(proto)));
  return violations.ToStatus();
}

absl::StatusOr<std::vector<VertexAssignment>> FromProto(
    const AssignmentList& proto, int vertex_count) {
  Violations violations;
  std::vector<VertexAssignment> assignments;
  for (int i = 0; i < proto.size() && violations.empty(); ++i) {
    const std::string field = absl::StrCat("assignments[", i, "]");
    CheckId(field + ".link_id", proto[i].link_id(), violations);
    const absl::StatusOr<AssignmentScope> scope = FromProto(proto[i].scope());
    violations.AddStatus(field, scope.status());
    const absl::StatusOr<std::vector<int>> vertices =
        convert::FromProto(proto[i].vertices(), vertex_count);
    violations.AddStatus(field + ".vertices", vertices.status());
    if (!violations.empty()) break;
    if (assignments.size() + vertices->size() >
        static_cast<size_t>(vertex_count)) {
      violations.Add(field + ".vertices",
                     absl::StrCat("want at most ", vertex_count,
                                  " vertices in all assignments"));
      break;
    }
    for (int vertex : *vertices) {
      assignments.push_back({vertex, proto[i].link_id(), *scope});
    }
  }
  if (!violations.empty()) return violations.ToStatus();
  return assignments;
}

void ToProto(const std::vector<VertexAssignment>& assignments,
             AssignmentList* proto) {
  std::map<std::pair<std::string, AssignmentScope>, std::vector<int>> groups;
  for (const VertexAssignment& assignment : assignments) {
    groups[{assignment.link_id, assignment.scope}].push_back(assignment.vertex);
  }
  for (const auto& [key, vertices] : groups) {
    v1::VertexAssignment* out = proto->Add();
    out->set_link_id(key.first);
    out->set_scope(ToProto(key.second));
    convert::ToProto(vertices, out->mutable_vertices());
  }
}

absl::StatusOr<VertexSelector> FromProto(const v1::VertexSelector& proto,
                                         int vertex_count) {
  Violations violations;
  switch (proto.kind_case()) {
    case v1::VertexSelector::kVertices: {
      absl::StatusOr<std::vector<int>> vertices =
          convert::FromProto(proto.vertices(), vertex_count);
      violations.AddStatus("vertices", vertices.status());
      if (!violations.empty()) return violations.ToStatus();
      return SelectIds{*std::move(vertices)};
    }
    case v1::VertexSelector::kSphere:
      return SelectSphere{convert::FromProto(proto.sphere().center()),
                          proto.sphere().radius_m()};
    case v1::VertexSelector::kBox:
      return SelectBox{convert::FromProto(proto.box().lowest()),
                       convert::FromProto(proto.box().highest())};
    case v1::VertexSelector::kComponentVertex:
      return SelectComponent{proto.component_vertex()};
    case v1::VertexSelector::kRay:
      return SelectRay{convert::FromProto(proto.ray().origin()),
                       convert::FromProto(proto.ray().direction()),
                       proto.ray().geodesic_radius_m()};
    case v1::VertexSelector::KIND_NOT_SET:
      break;
  }
  violations.Add("kind",
                 "want one of vertices, sphere, box, component_vertex and ray");
  return violations.ToStatus();
}

}  // namespace gelenk::convert
