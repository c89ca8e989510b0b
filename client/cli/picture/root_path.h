// Where the body went, seen from above.
#ifndef CLIENT_CLI_PICTURE_ROOT_PATH_H_
#define CLIENT_CLI_PICTURE_ROOT_PATH_H_

#include "client/cli/picture/svg.h"
#include "client/cli/play/playback.h"

namespace gelenk::cli {

// The path of the hips, or of the root where there are none: the clip's broad
// and pale, the answers' on top of it; dots mark start and end, a bar tells the
// scale.
void DrawRootPath(const Playback& playback, const Box& box, Svg& svg);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_ROOT_PATH_H_
