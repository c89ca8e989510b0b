// Reads AMC text, the motion of an ASF skeleton.
//
// Every frame names its number, one more than that of the frame before, and
// every bone that moves with all of its numbers, in any order. Comments (#) and
// remarks (:FULLY-SPECIFIED) are fine; :DEGREES and :RADIANS count. Errors as
// of ReadAsf. Cost: linear.
#ifndef GELENK_FORMATS_AMC_READER_H_
#define GELENK_FORMATS_AMC_READER_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/formats/asf_document.h"
#include "gelenk/formats/bvh_reader.h"

namespace gelenk {

absl::StatusOr<AmcMotion> ReadAmc(absl::string_view bytes,
                                  const AsfDocument& skeleton,
                                  const BvhBounds& bounds = {});

}  // namespace gelenk

#endif  // GELENK_FORMATS_AMC_READER_H_
