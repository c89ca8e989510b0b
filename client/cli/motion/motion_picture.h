// The contact sheet of a motion file.
#ifndef CLIENT_CLI_MOTION_MOTION_PICTURE_H_
#define CLIENT_CLI_MOTION_MOTION_PICTURE_H_

#include <string>

#include "absl/status/status.h"
#include "client/cli/motion/body_file.h"

namespace gelenk::cli {

// Writes it to `path`: of `body`, below its reference where there is one, whose
// contacts count. Both have passed Measure.
absl::Status WriteMotionPicture(const BodyFile& body, const BodyFile* reference,
                                const std::string& path);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_MOTION_PICTURE_H_
