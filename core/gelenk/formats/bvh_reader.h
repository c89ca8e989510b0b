// Reads BVH (Biovision hierarchy) text.
//
// Strict where a file is malformed, lenient where exporters differ: byte order
// mark; LF, CR LF, CR; any case of keywords; names with spaces, colons, UTF-8;
// braces on any line; zero to six channels in any order on any joint; End Site
// missing or named; a hierarchy without motion; a frame spread over lines; rows
// beyond the number of frames (dropped). Each such oddity is a warning.
//
// Numbers are read exactly and do not depend on the locale. Never recursive;
// memory is bounded by the bounds below and by the bytes given.
//
// Errors: INVALID_ARGUMENT `line 3, column 9: expected a number, got "1,5"`;
// columns count bytes. Cost: linear, about 20 million numbers a second.
#ifndef GELENK_FORMATS_BVH_READER_H_
#define GELENK_FORMATS_BVH_READER_H_

#include <cstddef>
#include <cstdint>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/formats/bvh_document.h"

namespace gelenk {

// Largest files taken. Far beyond real captures, small enough that a hostile
// file costs neither minutes nor all memory.
struct BvhBounds {
  // An hour of a body with fingers at 120 Hz is about 250 MB of text.
  size_t max_bytes = size_t{256} << 20;
  // What SkeletonBounds takes.
  int max_joints = 1024;
  int max_end_sites = 1024;
  // A rope is deep, a body about 12.
  int max_depth = 256;
  // A day at 120 Hz.
  int64_t max_frames = 10'000'000;
  // frames * channels: half a GiB of doubles.
  int64_t max_numbers = int64_t{64} << 20;
  // Exporters cut names far below; a longer one is a missing line break.
  size_t max_name_bytes = 1024;
};

absl::StatusOr<BvhDocument> ReadBvh(absl::string_view bytes,
                                    const BvhBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_READER_H_
