// Poses of a body as messages of the VMC protocol.
#ifndef CLIENT_CLI_VMC_VMC_WRITER_H_
#define CLIENT_CLI_VMC_VMC_WRITER_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"

namespace gelenk::cli {

class VmcWriter {
 public:
  explicit VmcWriter(std::shared_ptr<const BodyModel> body);

  // Root, every bone that has a role, OK and time, in one bundle. Rotations are
  // from the T-pose, in the axes of the world, as receivers turn a humanoid.
  std::string Write(const Eigen::VectorXd& positions, double time_s);

 private:
  struct Bone {
    std::string name;
    BodyRole role;
    // Of the nearest bone above that is sent; of the hips its own.
    BodyRole parent;
  };

  std::shared_ptr<const BodyModel> body_;
  BodyPoseReader reader_;
  BodyPose pose_;
  std::vector<Bone> bones_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_VMC_WRITER_H_
