// Where in a text a reader is when it objects.
#ifndef GELENK_FORMATS_TEXT_POSITION_H_
#define GELENK_FORMATS_TEXT_POSITION_H_

#include <cstddef>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace gelenk {

// Lines end with LF, CR LF or CR; columns count bytes. Lines are counted on
// from the last call, so that many calls cost linear time together. The text
// must outlive this.
class TextPosition {
 public:
  explicit TextPosition(absl::string_view text) : text_(text) {}

  // "line 3, column 9", both from 1. `at` is not before that of the last call.
  std::string Of(size_t at);

  // INVALID_ARGUMENT `<position>: expected <what>, got "<token>"`; the token is
  // cut where it is long. `no_token` is what an empty one means.
  absl::Status Expected(size_t at, absl::string_view what,
                        absl::string_view token, absl::string_view no_token);

 private:
  absl::string_view text_;
  // Lines that end before it are counted.
  size_t counted_ = 0;
  size_t line_ = 1;
  size_t line_start_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_FORMATS_TEXT_POSITION_H_
