// One picture of a played clip: the body over time with its targets, where it
// went, how far it was off, and how each frame ended.
#ifndef CLIENT_CLI_PICTURE_PLAY_PICTURE_H_
#define CLIENT_CLI_PICTURE_PLAY_PICTURE_H_

#include <string>

#include "client/cli/play/playback.h"
#include "client/cli/play/residuals.h"

namespace gelenk::cli {

// A picture that needs nothing but itself. `playback` has a frame or more.
std::string PlayPictureSvg(const Playback& playback,
                           const Residuals& residuals);

// The same in a page for browsers.
std::string PlayPictureHtml(const Playback& playback,
                            const Residuals& residuals);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_PLAY_PICTURE_H_
