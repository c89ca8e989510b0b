// How every frame ended, as a coloured strip over time.
#ifndef CLIENT_CLI_PICTURE_OUTCOME_STRIP_H_
#define CLIENT_CLI_PICTURE_OUTCOME_STRIP_H_

#include "client/cli/picture/svg.h"
#include "client/cli/play/playback.h"

namespace gelenk::cli {

// Of the frames that share a column of pixels the worst shows.
void DrawOutcomeStrip(const Playback& playback, const Box& box, Svg& svg);

// A key to the colours that occur, from `at` to the right, with shares.
void DrawOutcomeKey(const Playback& playback, const Point& at, Svg& svg);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_OUTCOME_STRIP_H_
