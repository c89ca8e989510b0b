// Sets of vertices as runs.
#ifndef GELENK_CONVERT_VERTEX_RUNS_H_
#define GELENK_CONVERT_VERTEX_RUNS_H_

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/v1/skin.pb.h"

namespace gelenk::convert {

// Rising. INVALID_ARGUMENT unless the runs rise, do not overlap and lie within
// a mesh of `vertex_count`: so a small message cannot become a large answer.
absl::StatusOr<std::vector<int>> FromProto(const v1::VertexRuns& proto,
                                           int vertex_count);

// `vertices` rise.
void ToProto(absl::Span<const int> vertices, v1::VertexRuns* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_VERTEX_RUNS_H_
