#include "convert/vertex_runs.h"

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {

absl::StatusOr<std::vector<int>> FromProto(const v1::VertexRuns& proto,
                                           int vertex_count) {
  Violations violations;
  if (proto.starts_size() != proto.lengths_size()) {
    violations.Add("lengths",
                   absl::StrCat("want ", proto.starts_size(),
                                " as starts, got ", proto.lengths_size()));
    return violations.ToStatus();
  }
  std::vector<int> vertices;
  int64_t next = 0;
  for (int i = 0; i < proto.starts_size(); ++i) {
    const int64_t start = proto.starts(i);
    const int64_t end = start + proto.lengths(i);
    if (start < next || end <= start || end > vertex_count) {
      violations.Add(
          absl::StrCat("starts[", i, "]"),
          absl::StrCat("want runs that rise within 0 to ", vertex_count - 1,
                       ", got ", proto.lengths(i), " from ", start));
      return violations.ToStatus();
    }
    for (int64_t v = start; v < end; ++v) {
      vertices.push_back(static_cast<int>(v));
    }
    next = end;
  }
  return vertices;
}

void ToProto(absl::Span<const int> vertices, v1::VertexRuns* proto) {
  int next = -1;
  for (int vertex : vertices) {
    if (vertex != next) {
      proto->add_starts(vertex);
      proto->add_lengths(0);
    }
    const int last = proto->lengths_size() - 1;
    proto->set_lengths(last, proto->lengths(last) + 1);
    next = vertex + 1;
  }
}

}  // namespace gelenk::convert
