// One leg seen from its side at many moments, where it is at each: what slides
// and what sinks can be seen.
#ifndef CLIENT_CLI_PICTURE_LEG_PICTURE_H_
#define CLIENT_CLI_PICTURE_LEG_PICTURE_H_

#include <string>

#include "absl/strings/string_view.h"
#include "client/cli/examples/leg_example.h"

namespace gelenk::cli {

// The left leg on its whole way and, close up, its foot while it stands
// longest. The ways of heel and ball are lines, red while they are planted: a
// planted point that stays where it is leaves a dot.
std::string LegPictureSvg(const LegExample& example, const LegMotion& motion,
                          absl::string_view title);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_LEG_PICTURE_H_
