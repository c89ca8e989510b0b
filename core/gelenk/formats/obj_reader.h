// Reads the triangles of a Wavefront OBJ file.
//
// v, vn and f are read: corners as v, v/vt, v//vn and v/vt/vn, by numbers from
// 1 or, negative, back from the last; triangles, quads and polygons, cut as a
// fan from their first corner. Groups, objects, materials and texture
// coordinates are not looked at. Lines end with LF, CR LF or CR; a backslash at
// the end of a line continues it; a byte order mark is fine.
//
// Every v is a vertex of the mesh, in the file's order, so that selections by
// number fit other programs. A vertex has one normal: the mean of those that
// the corners there name, or of the triangles around it. Hard edges are smooth.
//
// Errors: INVALID_ARGUMENT `line 3, column 9: expected a number, got "1,5"`;
// columns count bytes. Cost: linear, about 10 million numbers a second.
#ifndef GELENK_FORMATS_OBJ_READER_H_
#define GELENK_FORMATS_OBJ_READER_H_

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/skin/triangle_mesh.h"

namespace gelenk {

struct ObjOptions {
  // Length of the file's unit, m: the format does not say.
  double unit_m = 1;
  // A scan of a million vertices has about 150 MB of text.
  size_t max_bytes = size_t{256} << 20;
  MeshBounds bounds = {};
};

struct ObjMesh {
  TriangleMesh mesh;
  // What was left out: lines, points, free-form curves and surfaces.
  std::vector<std::string> warnings;
};

absl::StatusOr<ObjMesh> ReadObj(absl::string_view text,
                                const ObjOptions& options = {});

}  // namespace gelenk

#endif  // GELENK_FORMATS_OBJ_READER_H_
