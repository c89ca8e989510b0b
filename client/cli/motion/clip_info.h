// What a motion file holds, for people and for programs.
#ifndef CLIENT_CLI_MOTION_CLIP_INFO_H_
#define CLIENT_CLI_MOTION_CLIP_INFO_H_

#include <string>

#include "client/cli/motion/motion_file.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {

std::string ClipInfoText(const MotionFile& file);
Json ClipInfoJson(const MotionFile& file);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_MOTION_CLIP_INFO_H_
