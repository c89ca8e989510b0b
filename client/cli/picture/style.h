// The looks of the picture: readable on light and on dark paper.
#ifndef CLIENT_CLI_PICTURE_STYLE_H_
#define CLIENT_CLI_PICTURE_STYLE_H_

#include "absl/strings/string_view.h"
#include "gelenk/ik/solve_report.h"

namespace gelenk::cli {

// CSS without variables, which drawing programs do not know.
absl::string_view PictureStyle();

// The class that fills an area with an outcome's colour.
absl::string_view OutcomeClass(SolveOutcome outcome);
inline constexpr absl::string_view kUnansweredClass = "unanswered";

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_STYLE_H_
