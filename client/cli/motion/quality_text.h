// What was measured of a motion, for people and for programs. Definitions:
// docs/motion-quality.md.
#ifndef CLIENT_CLI_MOTION_QUALITY_TEXT_H_
#define CLIENT_CLI_MOTION_QUALITY_TEXT_H_

#include <string>

#include "client/cli/text/format.h"
#include "gelenk/retarget/moving_body.h"

namespace gelenk::cli {

std::string MeasuredText(const MeasuredMotion& measured);
Json MeasuredJson(const MeasuredMotion& measured);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_QUALITY_TEXT_H_
