// The net of a NURBS surface made so fine that it follows a rig.
//
// The surface's points at the Greville abscissae are bound to the volumes and
// move; the net interpolates them. Knots are inserted, which changes nothing at
// rest, until at probe poses, every joint bent either way, the interpolated
// surface is within the tolerance of the deformed one, or the net has all the
// points it may.
#ifndef GELENK_SKIN_NURBS_FIT_H_
#define GELENK_SKIN_NURBS_FIT_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/nurbs_surface.h"
#include "gelenk/skin/nurbs_topology.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

struct NurbsFit {
  // With the knots that were inserted.
  NurbsSurface surface;
  NurbsTopology topology;
  // The Greville points as a mesh; `vertices` has that of each point of the
  // net.
  std::shared_ptr<const LayeredSkin> greville;
  std::vector<int> vertices;
  // Net from Greville points.
  Eigen::MatrixXd u_inverse;
  Eigen::MatrixXd v_inverse;
  // At the probe poses.
  std::vector<NurbsSurface> deformed;
  // Largest distance found there, m.
  double error_m = 0;
  // Middles of the knot spans that are off by more than the tolerance.
  std::vector<double> bad_u;
  std::vector<double> bad_v;
};

// Errors: INVALID_ARGUMENT where the Greville points do not determine the net,
// or those of binding them.
absl::StatusOr<NurbsFit> FitNurbs(const VolumeRig& rig,
                                  const NurbsSurface& surface,
                                  double tolerance_m, int max_points);

}  // namespace gelenk

#endif  // GELENK_SKIN_NURBS_FIT_H_
