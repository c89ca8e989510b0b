// Where one point lies in the volumes of a rig at rest.
#ifndef GELENK_SKIN_VERTEX_PLACEMENT_H_
#define GELENK_SKIN_VERTEX_PLACEMENT_H_

#include <Eigen/Core>
#include <vector>

#include "gelenk/skin/skin_binding.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

struct Placement {
  int link = -1;
  int volume = -1;
  VolumeCoordinates at;
  // Distance from the bone as a part of the section; beyond a cap's plane that
  // way counts, too.
  double radius = 0;
  // From the bone to the point, rest pose, m.
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
};

class VertexPlacer {
 public:
  explicit VertexPlacer(const VolumeRig& rig);

  // The best placement in each link that could hold `point` within `reach`
  // sections.
  void FindNear(const Eigen::Vector3d& point, double reach,
                std::vector<Placement>& placements) const;

  // The best within a chain, however far.
  Placement InChain(const Eigen::Vector3d& point, int chain) const;
  // In the link's own volumes, rigid beyond its ends.
  Placement InLink(const Eigen::Vector3d& point, int link) const;

  // The nearest link by the distance from its bone.
  int NearestLink(const Eigen::Vector3d& point) const;
  double DistanceFromBone(const Eigen::Vector3d& point, int link) const;

  // Appends what branches have of `point`, which is placed in `placement`, and
  // turns that into a placement in the parent where it was one in a stub; or
  // into one in a branch that has all of it.
  void AddShares(const Eigen::Vector3d& point, Placement& placement,
                 std::vector<BlendShare>& shares) const;

 private:
  double Slack(int link) const;
  bool InVolume(const Eigen::Vector3d& point, int volume,
                Placement* placement) const;
  bool InCap(const Eigen::Vector3d& point, int link,
             Placement* placement) const;
  bool BestInLink(const Eigen::Vector3d& point, int link,
                  Placement* placement) const;

  const VolumeRig& rig_;
  std::vector<int> branches_;  // links
};

}  // namespace gelenk

#endif  // GELENK_SKIN_VERTEX_PLACEMENT_H_
