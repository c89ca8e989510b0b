// The reach of an end effector, drawn.
#ifndef CLIENT_CLI_PICTURE_WORKSPACE_PICTURE_H_
#define CLIENT_CLI_PICTURE_WORKSPACE_PICTURE_H_

#include <string>

#include "absl/strings/string_view.h"
#include "gelenk/workspace/planar_annulus.h"
#include "gelenk/workspace/workspace_map.h"

namespace gelenk::cli {

// The ring, with its radii.
std::string WorkspacePictureSvg(const PlanarAnnulus& annulus,
                                absl::string_view effector);

// The map as seen along each axis on which it is more than one voxel deep; the
// darker, the more agile: the best mean manipulability behind a pixel.
std::string WorkspacePictureSvg(const WorkspaceMap& map,
                                absl::string_view effector);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_WORKSPACE_PICTURE_H_
