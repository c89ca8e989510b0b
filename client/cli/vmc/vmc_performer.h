// A performer's bones as a skeleton and its poses.
#ifndef CLIENT_CLI_VMC_VMC_PERFORMER_H_
#define CLIENT_CLI_VMC_VMC_PERFORMER_H_

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/vmc/vmc_reader.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::cli {

class VmcPerformer {
 public:
  // The bones that `frame` has, as long as they are there; the hips are free,
  // the others turn. FAILED_PRECONDITION naming what is missing while it has no
  // hips or neither legs nor arms.
  static absl::StatusOr<VmcPerformer> Create(const VmcFrame& frame);

  // Its rest pose is the T-pose.
  const std::shared_ptr<const Skeleton>& skeleton() const { return skeleton_; }
  // Which bone is which, in the performer's own word.
  std::vector<JointMapOverride> roles() const;

  // Whether a frame is of the same bones and lengths.
  bool Fits(const VmcFrame& frame) const;

  // Bones that the skeleton does not have are left out.
  Eigen::VectorXd PositionsOf(const VmcFrame& frame) const;

 private:
  VmcPerformer() = default;

  std::shared_ptr<const Skeleton> skeleton_;
  // Of each bone its joint; -1 for none.
  std::array<int, kHumanBoneCount> joints_;
};

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_VMC_VMC_PERFORMER_H_
