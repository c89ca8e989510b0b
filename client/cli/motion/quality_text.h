// What was measured of a motion, for people and for programs. Definitions:
// docs/motion-quality.md.
#ifndef CLIENT_CLI_MOTION_QUALITY_TEXT_H_
#define CLIENT_CLI_MOTION_QUALITY_TEXT_H_

#include <optional>
#include <string>

#include "client/cli/motion/body_file.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {

struct Measured {
  MotionQuality quality;
  // Beside the motion that it was made from.
  std::optional<MotionQuality> source;
  std::optional<MotionComparison> comparison;
};

// INVALID_ARGUMENT for files without motion, or whose frames are not as many.
// With a reference, its contacts count and the ground is flat, at height 0.
absl::StatusOr<Measured> Measure(const BodyFile& body,
                                 const BodyFile* reference);

std::string MeasuredText(const Measured& measured);
Json MeasuredJson(const Measured& measured);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_QUALITY_TEXT_H_
