// Unity's axes are left-handed: X to the right, Y up, Z forward. Ours are
// right-handed with X to the left. The way there is the way back.
#ifndef CLIENT_CLI_VMC_UNITY_AXES_H_
#define CLIENT_CLI_VMC_UNITY_AXES_H_

#include "gelenk/math/rigid_transform.h"

namespace gelenk::cli {

inline RigidTransform MirrorAxes(const RigidTransform& transform) {
  const Eigen::Quaterniond& q = transform.rotation;
  const Eigen::Vector3d& p = transform.translation;
  return {Eigen::Quaterniond(q.w(), q.x(), -q.y(), -q.z()),
          Eigen::Vector3d(-p.x(), p.y(), p.z())};
}

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_UNITY_AXES_H_
