// The volumes of a rig as bytes: the free planes of each link, from which a
// client derives all others and deforms the mesh itself.
//
// Per link P1, P2, P4, P5, then per branch S0 and S2 of its stub; a plane is
// nine floats: center, s_axis, t_axis, little-endian. P3, P0 and P6, S1 and S3
// follow (see volume_rig.h), at chain ends by the link's spacing. 144 bytes a
// link.
#ifndef GELENK_SKIN_CONTROL_PLANE_STREAM_H_
#define GELENK_SKIN_CONTROL_PLANE_STREAM_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/skin/bezier_volume.h"
#include "gelenk/skin/volume_rig.h"

namespace gelenk {

// Replaces `bytes`.
void EncodeControlPlanes(const VolumeRig& rig, const VolumeFrame& frame,
                         uint32_t frame_number, std::string& bytes);

// What of a link the planes of its volumes are derived by: all that a client
// needs of a rig.
struct PlaneLink {
  // Indices of links, -1 for none; parents come first.
  int parent = -1;
  int continuation = -1;
  double length_m = 0;
  double start_spacing_m = 0;
  double end_spacing_m = 0;
  bool is_branch = false;
};

std::vector<PlaneLink> PlaneLinksOf(const VolumeRig& rig);

// 3 a link and one a branch.
int VolumeCountOf(absl::Span<const PlaneLink> links);

// The volumes, by the rig's numbers, rounded to floats. `links` are sound (see
// CheckPlaneLinks). INVALID_ARGUMENT for what is malformed or of another rig.
absl::Status DecodeControlPlanes(absl::Span<const PlaneLink> links,
                                 absl::string_view bytes,
                                 std::vector<BezierVolume>& volumes);
absl::Status DecodeControlPlanes(const VolumeRig& rig, absl::string_view bytes,
                                 std::vector<BezierVolume>& volumes);

// INVALID_ARGUMENT listing links whose neighbours are none, or whose lengths
// are no positive numbers.
absl::Status CheckPlaneLinks(absl::Span<const PlaneLink> links);

}  // namespace gelenk

#endif  // GELENK_SKIN_CONTROL_PLANE_STREAM_H_
