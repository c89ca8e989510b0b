// A NURBS surface on the volumes of a rig.
//
// Moving control points with the volumes would bend the net, not the surface.
// Instead the points of the surface at the Greville abscissae of the net are
// bound and moved, and the net is what interpolates them: exact for rigid and
// affine motions, and as near as the net is fine. So knots are inserted, which
// changes nothing at rest, until at probe poses (every joint bent) the surface
// is within the tolerance of the deformed one. Weights do not change.
//
// What is drawn is a triangle mesh at fixed parameters: bases are computed
// once, a frame is two small products. Seams of closed surfaces are welded,
// poles have one vertex and one normal.
//
// Errors: those of CheckNurbs; INVALID_ARGUMENT also where the Greville points
// do not determine the net (knots that are not clamped).
#ifndef GELENK_SKIN_NURBS_SKIN_H_
#define GELENK_SKIN_NURBS_SKIN_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/kernel/tessellate_layout.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/nurbs_fit.h"
#include "gelenk/skin/nurbs_surface.h"
#include "gelenk/skin/nurbs_tessellation.h"
#include "gelenk/skin/nurbs_topology.h"
#include "gelenk/skin/skin.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

struct NurbsSkinOptions {
  // Between the skin and the deformed surface, at the probe poses, and between
  // triangles and surface at rest.
  double tolerance_m = 1e-3;
  // Refinement stops before the net has more points.
  int max_points = 1 << 13;
  int max_vertices = 1 << 18;
};

class NurbsSkin : public Skin {
 public:
  static absl::StatusOr<std::shared_ptr<const NurbsSkin>> Create(
      const VolumeRig& rig, const NurbsSurface& surface,
      const NurbsSkinOptions& options = {});

  // With the knots that were inserted.
  const NurbsSurface& surface() const { return surface_; }
  const NurbsSkinOptions& options() const { return options_; }
  // Largest distance that was found at the probe poses, m: more than the
  // tolerance where max_points stopped the refinement.
  double estimated_error_m() const { return estimated_error_m_; }
  // The Greville points as a mesh, and their binding.
  const LayeredSkin& greville_skin() const { return *greville_; }

  // The same surface on other muscles, refined further where they ask for it.
  absl::StatusOr<std::shared_ptr<const NurbsSkin>> WithMuscles(
      const SkinMuscles& muscles) const;

  // At the parameters of a vertex.
  Eigen::Vector2d parameters(int vertex) const;

  void Deform(const ConstVectorView& positions,
              const RigidTransform& world_from_skeleton,
              SkinWorkspace& workspace, VertexBlocks& blocks) const override;

  // The net at a pose, in double precision, to be evaluated by EvaluateNurbs.
  NurbsSurface DeformedSurface(const ConstVectorView& positions,
                               const RigidTransform& world_from_skeleton) const;

  size_t ByteSize() const override;

 private:
  NurbsSkin(const VolumeRig& rig, const NurbsSkinOptions& options, NurbsFit fit,
            NurbsTessellation tessellation);

  // Rows w x, w y, w z of all points, into workspace.net.
  void FitNet(const VolumeFrame& frame, SkinWorkspace& workspace) const;
  void MendNormals(VertexBlocks& blocks) const;

  NurbsSkinOptions options_;
  NurbsSurface surface_;
  NurbsTopology topology_;
  std::shared_ptr<const LayeredSkin> greville_;
  std::vector<int> greville_vertices_;  // of each point of the net
  std::vector<double> greville_weights_;
  Eigen::MatrixXd u_inverse_;  // net from Greville points
  Eigen::MatrixXd v_inverse_;
  double estimated_error_m_;
  NurbsTessellation tessellation_;
  kernel::TessellateFunction tessellate_;
};

}  // namespace gelenk

#endif  // GELENK_SKIN_NURBS_SKIN_H_
