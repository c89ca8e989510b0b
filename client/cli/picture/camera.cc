#include "client/cli/picture/camera.h"

#include <numbers>

#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk::cli {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kAzimuthRad = 35 * kDegree;
constexpr double kElevationRad = 9 * kDegree;

// The horizontal part of `direction`, unit; zero when it has none.
Eigen::Vector3d Horizontal(const Eigen::Vector3d& direction,
                           const Eigen::Vector3d& up) {
  const Eigen::Vector3d flat = direction - direction.dot(up) * up;
  return flat.norm() < 1e-6 ? Eigen::Vector3d::Zero() : flat.normalized();
}

Eigen::Vector3d AnyHorizontal(const Eigen::Vector3d& up) {
  return Horizontal(up.z() * up.z() < 0.5
                        ? Eigen::Vector3d::UnitZ()
                        : Eigen::Vector3d(-Eigen::Vector3d::UnitY()),
                    up);
}

// Where the body faces: across the line from its right to its left hand and
// foot.
Eigen::Vector3d FacingOf(const Playback& playback,
                         const Eigen::VectorXd& pose) {
  const BodyParts& body = playback.body;
  const Eigen::Vector3d& up = playback.skeleton->up();
  if (!body.HasLimbs()) return AnyHorizontal(up);
  WorldTransforms frames;
  ForwardKinematics(*playback.skeleton, pose, frames);
  const Eigen::Vector3d to_left =
      frames[body.left_hand].translation - frames[body.right_hand].translation +
      frames[body.left_foot].translation - frames[body.right_foot].translation;
  const Eigen::Vector3d facing = Horizontal(to_left.cross(up), up);
  return facing.isZero() ? AnyHorizontal(up) : facing;
}

}  // namespace

Camera::Camera(const Eigen::Vector3d& up, const Eigen::Vector3d& toward_viewer)
    : right_(up.cross(toward_viewer).normalized()),
      down_(-toward_viewer.cross(right_).normalized()) {}

Camera CameraFor(const Playback& playback) {
  const Eigen::Vector3d& up = playback.skeleton->up();
  const Eigen::Vector3d facing = FacingOf(
      playback, playback.clip_poses.col(playback.clip_poses.cols() / 2));
  const Eigen::Vector3d from_side = Eigen::AngleAxisd(kAzimuthRad, up) * facing;
  return Camera(
      up, std::cos(kElevationRad) * from_side + std::sin(kElevationRad) * up);
}

Camera MapCamera(const Eigen::Vector3d& up) {
  // Seen from above, with the forward direction upwards on the picture.
  return Camera(AnyHorizontal(up), up);
}

}  // namespace gelenk::cli
