// Cuts BVH text into tokens and says where a reader is when it objects.
//
// A token is a brace or a run of other characters without blanks. Nothing is
// copied; the text must outlive the scanner.
#ifndef GELENK_FORMATS_BVH_SCANNER_H_
#define GELENK_FORMATS_BVH_SCANNER_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "gelenk/formats/text_position.h"

namespace gelenk {

class BvhScanner {
 public:
  explicit BvhScanner(absl::string_view text) : text_(text), position_(text) {}

  // Returns true when a line ended among the blanks.
  bool SkipBlanks();
  // After SkipBlanks.
  bool AtEnd() const { return at_ == text_.size(); }
  size_t BytesLeft() const { return text_.size() - at_; }

  // The next token, left in place; empty at the end of the text.
  absl::string_view Peek();
  absl::string_view Take();

  // Takes the next token if it is `keyword`, in any case.
  bool TakeKeyword(absl::string_view keyword);
  // The same for a run of letters: "Frames" in "Frames:20".
  bool TakeWord(absl::string_view word);
  bool TakeColon();

  // From the next token to the end of its line or to a brace that opens,
  // without blanks around it.
  absl::string_view TakeName();

  // Up to the end of the line.
  void SkipLine();

  // A finite decimal number, whatever the locale; a sign + and a missing zero
  // before the point are fine. At most kMaxMagnitude.
  absl::StatusOr<double> TakeNumber();
  // An integer >= 0.
  absl::StatusOr<int64_t> TakeCount();

  // "line 3, column 9", both from 1, of the next token.
  std::string Position();
  // INVALID_ARGUMENT `<position>: expected <what>, got "<next token>"`.
  absl::Status Expected(absl::string_view what);

  // No length in any unit and no angle comes near; keeps squares finite.
  static constexpr double kMaxMagnitude = 1e9;

 private:
  absl::string_view text_;
  size_t at_ = 0;
  TextPosition position_;
};

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_SCANNER_H_
