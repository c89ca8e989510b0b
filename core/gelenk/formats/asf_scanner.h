// Tokens of ASF and AMC text: those of BVH without comments, which run from a
// token that begins with # to the end of its line.
#ifndef GELENK_FORMATS_ASF_SCANNER_H_
#define GELENK_FORMATS_ASF_SCANNER_H_

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"
#include "gelenk/formats/bvh_scanner.h"

namespace gelenk {

class AsfScanner : public BvhScanner {
 public:
  using BvhScanner::BvhScanner;

  // To the next token that is no comment; true when a line ended on the way.
  bool SkipToToken() {
    bool line_ended = SkipBlanks();
    while (absl::StartsWith(Peek(), "#")) {
      SkipLine();
      line_ended |= SkipBlanks();
    }
    return line_ended;
  }

  // A section of an ASF file, a remark of an AMC file.
  bool IsAtSection() {
    SkipToToken();
    return absl::StartsWith(Peek(), ":");
  }
};

}  // namespace gelenk

#endif  // GELENK_FORMATS_ASF_SCANNER_H_
