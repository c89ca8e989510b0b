// How far the answers are from the clip's targets, measured on this side: by
// forward kinematics of the joint angles that came back, without trusting what
// the service says about them.
#ifndef CLIENT_CLI_PLAY_RESIDUALS_H_
#define CLIENT_CLI_PLAY_RESIDUALS_H_

#include <string>
#include <vector>

#include "client/cli/play/playback.h"

namespace gelenk::cli {

struct Residuals {
  // One a frame, the worst goal's; 0 without an answer.
  std::vector<double> position_m;
  std::vector<double> rotation_rad;
  // The largest difference from what the service reported of any goal.
  double disagreement_m = 0;
  double disagreement_rad = 0;
  // How far the answers break the joint limits at worst, rad or m; the joint's
  // id, empty when all are inside.
  double limit_excess = 0;
  std::string limit_joint_id;
};

Residuals MeasureResiduals(const Playback& playback);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_RESIDUALS_H_
