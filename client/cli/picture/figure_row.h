// The body at a dozen moments of the clip, side by side.
#ifndef CLIENT_CLI_PICTURE_FIGURE_ROW_H_
#define CLIENT_CLI_PICTURE_FIGURE_ROW_H_

#include "client/cli/picture/svg.h"
#include "client/cli/play/playback.h"

namespace gelenk::cli {

inline constexpr int kMostFigures = 12;

// Each figure stands in its own place, under its time: the clip's pose pale
// behind the answer, rings at the targets, dots where the effectors are, and a
// line between them where it can be seen.
void DrawFigureRow(const Playback& playback, const Box& box, Svg& svg);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_FIGURE_ROW_H_
