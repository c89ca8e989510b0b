// Reads URDF (Unified Robot Description Format) text.
//
// Taken: links with mass and its centre; fixed, revolute, continuous,
// prismatic, planar and floating joints with origin, axis, limits and mimic.
// Everything else (geometry, transmissions, what simulators add) is skipped.
// A file that xacro has still to expand is refused with that hint.
//
// Read as the format has it: an axis that is not given is X; `lower` or `upper`
// that is not given is 0. Read as robots are: no <limit>, or one without both
// numbers, is unlimited, and so is a number of 1e9 or more; an axis of another
// length than 1 is normalised; a velocity limit of 0 is none. Each of these is
// a warning.
//
// Numbers do not depend on the locale. There are no entities but XML's own
// five, and no other file is ever opened. The parser nests 100 elements deep at
// most; its memory is bounded by the bounds below.
//
// Errors: INVALID_ARGUMENT that lists all that is malformed, as
// `line 42: <limit lower="abc"> of joint "elbow": not a number`. Cost: linear,
// about 100 MB/s.
#ifndef GELENK_IMPORT_URDF_READER_H_
#define GELENK_IMPORT_URDF_READER_H_

#include <cstddef>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/import/urdf_document.h"

namespace gelenk {

// Largest files taken. Checked before the parser takes memory, which is about
// 150 bytes an element and 100 an attribute.
struct UrdfBounds {
  // A humanoid with all its sensors is about 100 kB.
  size_t max_bytes = size_t{16} << 20;
  // Counted as `<` and `=`, wherever they are. That humanoid has 2,000 each.
  size_t max_elements = 200'000;
  size_t max_attributes = 400'000;
  // What SkeletonBounds takes.
  int max_joints = 1024;
};

absl::StatusOr<UrdfDocument> ReadUrdf(absl::string_view bytes,
                                      const UrdfBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_IMPORT_URDF_READER_H_
