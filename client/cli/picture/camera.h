// Looks at a body from a little above and to the side, without perspective.
#ifndef CLIENT_CLI_PICTURE_CAMERA_H_
#define CLIENT_CLI_PICTURE_CAMERA_H_

#include <Eigen/Core>

#include "client/cli/picture/svg.h"
#include "client/cli/play/playback.h"

namespace gelenk::cli {

class Camera {
 public:
  // `up` and `toward_viewer` are world directions, unit, not parallel; the
  // camera looks along -toward_viewer.
  Camera(const Eigen::Vector3d& up, const Eigen::Vector3d& toward_viewer);

  // m to the right and m downwards on the picture.
  Point Project(const Eigen::Vector3d& world_point) const {
    return {right_.dot(world_point), down_.dot(world_point)};
  }

 private:
  Eigen::Vector3d right_;
  Eigen::Vector3d down_;
};

// Sees the body three quarters from the front as it stands at the middle of
// the clip.
Camera CameraFor(const Playback& playback);

// Two horizontal directions, right and forward, of which the second is up on a
// map: X and Z where up is Y.
Camera MapCamera(const Eigen::Vector3d& up);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_CAMERA_H_
