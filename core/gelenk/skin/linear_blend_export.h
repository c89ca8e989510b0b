// A layered skin as weights of a plain linear-blend skin.
//
// F(u, s, t) = sum over k of B_k(u) P_k(s, t): four affine maps, blended with
// the Bernstein polynomials of u as weights. So every control plane becomes a
// bone, every vertex follows the four of its volume, and stands at (0, s, t) in
// their frames; what is rigid with a link follows a bone of the link's. A file
// format that knows nothing but bones and weights (glTF) holds the skin
// exactly, with the identity as every inverse bind matrix.
//
// Vertices near a branch, which several volumes share, are the exception: they
// follow the volume that has most of them, and are listed.
#ifndef GELENK_SKIN_LINEAR_BLEND_EXPORT_H_
#define GELENK_SKIN_LINEAR_BLEND_EXPORT_H_

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

using BoneMatrix = Eigen::Matrix<double, 3, 4>;

struct LinearBlendExport {
  // One a plane: "link/P0" .. "link/P6" of all links, then "link/S0" ..
  // "link/S3" of all stubs; then one a link: "link".
  std::vector<std::string> bones;
  struct Vertex {
    Eigen::Vector3d position;  // in the frame of its bones
    std::array<int, 4> bones;
    std::array<double, 4> weights;  // >= 0, sum 1
  };
  std::vector<Vertex> vertices;
  // Vertices that are not exact, rising.
  std::vector<int> inexact;
};

LinearBlendExport ExportLinearBlend(const LayeredSkin& skin);

// world_from_bone of all bones at a pose. The column that nothing depends on
// makes the matrix regular: s_axis x t_axis.
std::vector<BoneMatrix> BoneMatrices(const VolumeRig& rig,
                                     const VolumeFrame& frame);

}  // namespace gelenk

#endif  // GELENK_SKIN_LINEAR_BLEND_EXPORT_H_
