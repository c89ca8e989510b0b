#include "client/cli/skin/binding_text.h"

#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/cli/text/table.h"

namespace gelenk::cli {
namespace {

// Runs, edges and vertices that are listed for people.
constexpr int kListed = 12;

std::string ClassText(v1::BindingClass binding_class) {
  return absl::AsciiStrToLower(
      v1::BindingClass_Name(binding_class).substr(sizeof("BINDING_CLASS")));
}

int Total(const v1::BindingCounts& counts) {
  return counts.unique_count() + counts.ambiguous_count() +
         counts.outside_count() + counts.blend_count() + counts.user_count();
}

std::vector<std::string> CountCells(const std::string& name,
                                    const v1::BindingCounts& counts) {
  std::vector<std::string> cells = {name, absl::StrCat(Total(counts))};
  for (int count :
       {counts.unique_count(), counts.blend_count(), counts.ambiguous_count(),
        counts.outside_count(), counts.user_count()}) {
    cells.push_back(count == 0 ? "-" : absl::StrCat(count));
  }
  return cells;
}

std::string LinkId(const v1::Binding& binding, int link) {
  return binding.links(link).link_id();
}

std::string DeformerText(const v1::Skin& skin) {
  switch (skin.deformer_case()) {
    case v1::Skin::kLinearBlend:
      return "weights, linearly";
    case v1::Skin::kDualQuaternion:
      return "weights, dual quaternions";
    case v1::Skin::kRigidAttachment:
      return absl::StrCat("joint ", skin.rigid_attachment().joint_id());
    default:
      return absl::StrCat("volumes of ", skin.links_size(), " links, ",
                          skin.layered_volumes().muscles_size(), " muscles",
                          skin.has_binding_counts() ? "" : ", as a surface");
  }
}

void AppendEdges(const v1::Binding& binding, std::string* text) {
  if (binding.stretched_edge_count() == 0) return;
  absl::StrAppend(text, "\n", binding.stretched_edge_count(),
                  " edges between links that are not neighbours:\n");
  const int shown = std::min(kListed, binding.stretched_edges_size());
  for (int i = 0; i < shown; ++i) {
    const v1::Binding::StretchedEdge& edge = binding.stretched_edges(i);
    absl::StrAppend(text, "  ", edge.first_vertex(), " (",
                    LinkId(binding, edge.first_link()), ") - ",
                    edge.second_vertex(), " (",
                    LinkId(binding, edge.second_link()), ")\n");
  }
  if (shown < binding.stretched_edge_count()) absl::StrAppend(text, "  ...\n");
}

void AppendDoubtful(const v1::Binding& binding, std::string* text) {
  for (const v1::Binding::Class& vertices : binding.classes()) {
    if (vertices.binding_class() == v1::BINDING_CLASS_UNIQUE) continue;
    absl::StrAppend(text, "\n", ClassText(vertices.binding_class()), ": ",
                    RunsText(vertices.vertices()), "\n");
  }
  if (binding.ambiguous_size() > 0) absl::StrAppend(text, "\n");
  for (int i = 0; i < std::min(kListed, binding.ambiguous_size()); ++i) {
    const v1::Binding::Ambiguous& vertex = binding.ambiguous(i);
    absl::StrAppend(text, "vertex ", vertex.vertex(), " is on ",
                    LinkId(binding, vertex.bound_link()), "; candidates:");
    for (int k = 0; k < vertex.links_size(); ++k) {
      absl::StrAppend(text, " ", LinkId(binding, vertex.links(k)), " ",
                      Fixed(vertex.scores(k), 2));
    }
    absl::StrAppend(text, "\n");
  }
  if (binding.ambiguous_size() > kListed) absl::StrAppend(text, "...\n");
}

}  // namespace

std::string RunsText(const v1::VertexRuns& runs) {
  int count = 0;
  std::string list;
  for (int i = 0; i < runs.starts_size(); ++i) {
    const int first = runs.starts(i), length = runs.lengths(i);
    count += length;
    if (i > kListed) continue;
    if (i == kListed) {
      absl::StrAppend(&list, ", ...");
      continue;
    }
    absl::StrAppend(&list, i > 0 ? ", " : ": ", first);
    if (length > 1) absl::StrAppend(&list, "-", first + length - 1);
  }
  return absl::StrCat(count, count == 1 ? " vertex" : " vertices", list);
}

std::string BindingText(const v1::Skin& skin, const v1::Binding& binding) {
  Facts facts;
  facts.Add("skin", absl::StrCat(skin.name(), "@", skin.revision()));
  facts.Add("skeleton", skin.skeleton());
  facts.Add("deformed by", DeformerText(skin));
  facts.Add("vertices", absl::StrCat(skin.vertex_count()));
  facts.Add("triangles", absl::StrCat(skin.triangle_count()));
  facts.Add("memory", absl::StrCat(Fixed(skin.byte_size() / 1e6, 1), " MB"));
  if (skin.estimated_error_m() > 0) {
    facts.Add("off in a bend by",
              absl::StrCat(Fixed(1000 * skin.estimated_error_m(), 3), " mm"));
  }
  std::string text = facts.ToString();
  if (!skin.has_binding_counts()) return text;
  text += "\n";
  std::vector<Column> columns = {{"LINK"}};
  for (const char* title :
       {"VERTICES", "UNIQUE", "BLEND", "AMBIGUOUS", "OUTSIDE", "USER"}) {
    columns.push_back({title, Align::kRight});
  }
  Table table(columns);
  for (const v1::Binding::Link& link : binding.links()) {
    table.AddRow(CountCells(link.link_id(), link.counts()));
  }
  table.AddRow(CountCells("all", binding.counts()));
  text += table.ToString();
  AppendEdges(binding, &text);
  AppendDoubtful(binding, &text);
  return text;
}

Json BindingJson(const v1::Skin& skin, const v1::Binding& binding) {
  const auto json_of = [](const google::protobuf::Message& message) {
    google::protobuf::util::JsonPrintOptions options;
    options.always_print_primitive_fields = true;
    std::string json;
    // Fails only for Any and malformed times, which there are none of.
    google::protobuf::util::MessageToJsonString(message, &json, options).ok();
    return Json::parse(json, nullptr, /*allow_exceptions=*/false);
  };
  Json json = {{"skin", json_of(skin)}};
  if (skin.has_binding_counts()) json["binding"] = json_of(binding);
  return json;
}

std::string RebindText(const v1::RebindVerticesResponse& response,
                       bool dry_run) {
  const v1::BindingCounts& before = response.counts_before();
  const v1::BindingCounts& after = response.counts();
  std::string text = absl::StrCat("selected ", RunsText(response.selected()),
                                  "\n", dry_run ? "would move " : "moved ",
                                  RunsText(response.moved()), "\n\n");
  std::vector<Column> columns = {{""}};
  for (const char* title :
       {"VERTICES", "UNIQUE", "BLEND", "AMBIGUOUS", "OUTSIDE", "USER"}) {
    columns.push_back({title, Align::kRight});
  }
  Table table(columns);
  table.AddRow(CountCells("before", before));
  table.AddRow(CountCells("after", after));
  absl::StrAppend(&text, table.ToString(),
                  "stretched edges: ", response.stretched_edge_count(), "\n");
  if (!dry_run) {
    absl::StrAppend(&text, response.skin().name(), " is at revision ",
                    response.skin().revision(), "\n");
  }
  return text;
}

}  // namespace gelenk::cli
