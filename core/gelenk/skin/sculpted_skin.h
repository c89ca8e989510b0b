// A layered skin whose inner planes were sculpted: their 4 x 4 nets of control
// points are moved off the plane, one by one.
//
// The offsets ride on the free inner planes of a link, P2 and P4; P3 is midway
// between the sculpted nets as it is between the planes. So the volumes stay
// C1, within the link and at its ends. A vertex is bound to where the sculpted
// volume has it at rest: the rest pose gives back the mesh, in any other the
// skin follows the net. What several volumes share is sculpted by the share of
// its own volume. Beyond a section the offset is that of its edge.
//
// All other vertices go the fast way of LayeredSkin; sculpted ones cost some
// 0.3 us each. Nothing is allocated once the workspace is warm.
//
// Source: Sederberg and Parry, "Free-form deformation of solid geometric
// models", 1986.
#ifndef GELENK_SKIN_SCULPTED_SKIN_H_
#define GELENK_SKIN_SCULPTED_SKIN_H_

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/skin/bezier_volume.h"
#include "gelenk/skin/layered_skin.h"
#include "gelenk/skin/skin.h"

namespace gelenk {

struct SculptedPlane {
  std::string link_id;
  // 2 or 4.
  int plane = 2;
  // Of control point 4 i + j, at s = half_extents[0] * (2 i / 3 - 1) and so
  // along t: m along the plane's normal, s axis and t axis.
  std::array<Eigen::Vector3d, 16> offsets_m = {};
};

class SculptedSkin : public Skin {
 public:
  // Errors: INVALID_ARGUMENT that lists every malformed plane; or that names
  // the link and a vertex whose place at rest no coordinates have, as the
  // offsets turn the volume inside out there.
  static absl::StatusOr<std::shared_ptr<const SculptedSkin>> Create(
      std::shared_ptr<const LayeredSkin> skin,
      absl::Span<const SculptedPlane> planes);

  const LayeredSkin& layered_skin() const { return *skin_; }

  void Deform(const ConstVectorView& positions,
              const RigidTransform& world_from_skeleton,
              SkinWorkspace& workspace, VertexBlocks& blocks) const override;

  size_t ByteSize() const override;

 private:
  struct Sculpture {
    int link = -1;
    // Of P2 and P4.
    std::array<std::array<Eigen::Vector3d, 16>, 2> offsets_m = {};
  };
  struct Vertex {
    int slot;
    int sculpture;
    bool is_first_half;
    int volume;
    // Without the sculpture, and with it.
    VolumeCoordinates plain_at;
    VolumeCoordinates at;
    // The normal at rest by the sculpted volume.
    Eigen::Vector3d normal_components;
    // Of its own volume.
    double share;
  };

  SculptedSkin(std::shared_ptr<const LayeredSkin> skin,
               std::vector<Sculpture> sculptures);
  absl::Status BindVertices();

  // Of the sculpted volume.
  VolumePoint Evaluate(const Vertex& vertex, const VolumeFrame& frame) const;
  // Moves one vertex of a deformed skin.
  void Sculpt(const Vertex& vertex, const VolumeFrame& frame,
              VertexBlocks& blocks) const;

  std::shared_ptr<const LayeredSkin> skin_;
  std::vector<Sculpture> sculptures_;
  std::vector<Vertex> vertices_;
};

}  // namespace gelenk

#endif  // GELENK_SKIN_SCULPTED_SKIN_H_
