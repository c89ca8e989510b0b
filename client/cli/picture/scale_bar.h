// How long a metre is on a map.
#ifndef CLIENT_CLI_PICTURE_SCALE_BAR_H_
#define CLIENT_CLI_PICTURE_SCALE_BAR_H_

#include "client/cli/picture/svg.h"

namespace gelenk::cli {

// A bar of a round length, at most a third of the box wide, in its lower right
// corner.
void DrawScaleBar(double pixels_per_m, const Box& box, Svg& svg);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_SCALE_BAR_H_
