// Reads ASF text, the skeletons of Acclaim's motion capture.
//
// Strict where a file is malformed; byte order mark, any line end, any case of
// keywords, comments (#) and sections that are not known (skipped, with a
// warning) are fine. Bones are moved by rotations; translations, lengths that
// change and limits are not kept: the first two are errors, limits a warning.
//
// Errors: INVALID_ARGUMENT `line 3, column 9: expected a number, got "x"`.
// Never recursive. Cost: linear.
#ifndef GELENK_FORMATS_ASF_READER_H_
#define GELENK_FORMATS_ASF_READER_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/formats/asf_document.h"
#include "gelenk/formats/bvh_reader.h"

namespace gelenk {

// As for BVH: bones count as joints.
absl::StatusOr<AsfDocument> ReadAsf(absl::string_view bytes,
                                    const BvhBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_FORMATS_ASF_READER_H_
