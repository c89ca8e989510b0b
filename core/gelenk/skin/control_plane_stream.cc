#include "gelenk/skin/control_plane_stream.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/vertex_stream.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

constexpr int kFreePlanes[] = {1, 2, 4, 5};
constexpr int kFreeStubPlanes[] = {0, 2};
constexpr int kVolumesPerLink = 3;
constexpr size_t kPlaneBytes = 9 * sizeof(float);

int PlaneCount(absl::Span<const PlaneLink> links) {
  int count = static_cast<int>(std::size(kFreePlanes) * links.size());
  for (const PlaneLink& link : links) {
    if (link.is_branch) count += static_cast<int>(std::size(kFreeStubPlanes));
  }
  return count;
}

void Append(const ControlPlane& plane, std::string& bytes) {
  const Eigen::Matrix3f columns = plane.columns.cast<float>();
  bytes.append(reinterpret_cast<const char*>(columns.data()), kPlaneBytes);
}

ControlPlane Take(absl::string_view& bytes) {
  Eigen::Matrix3f columns;
  std::memcpy(columns.data(), bytes.data(), kPlaneBytes);
  bytes.remove_prefix(kPlaneBytes);
  return ControlPlane(columns.cast<double>());
}

// The same plane farther along its normal.
ControlPlane Shifted(const ControlPlane& plane, double distance_m) {
  ControlPlane shifted = plane;
  shifted.columns.col(0) +=
      distance_m * plane.s_axis().cross(plane.t_axis()).normalized();
  return shifted;
}

struct LinkPlanes {
  ControlPlane planes[kPlanesPerLink];
  ControlPlane stub[kPlanesPerStub];
};

}  // namespace

void EncodeControlPlanes(const VolumeRig& rig, const VolumeFrame& frame,
                         uint32_t frame_number, std::string& bytes) {
  bytes.clear();
  VertexStreamHeader header;
  header.encoding = VertexEncoding::kControlPlanes;
  header.frame_number = frame_number;
  header.block_count = PlaneCount(PlaneLinksOf(rig));
  AppendHeader(header, bytes);
  for (int i = 0; i < rig.link_count(); ++i) {
    for (int k : kFreePlanes) Append(frame.planes(i)[k], bytes);
  }
  const auto stubs =
      frame.all_planes().subspan(kPlanesPerLink * rig.link_count());
  for (size_t first = 0; first < stubs.size(); first += kPlanesPerStub) {
    for (int k : kFreeStubPlanes) Append(stubs[first + k], bytes);
  }
}

std::vector<PlaneLink> PlaneLinksOf(const VolumeRig& rig) {
  std::vector<PlaneLink> links;
  for (int i = 0; i < rig.link_count(); ++i) {
    links.push_back({rig.link(i).parent, rig.link(i).continuation,
                     rig.link(i).length_m, rig.start_spacing_m(i),
                     rig.end_spacing_m(i), rig.is_branch(i)});
  }
  return links;
}

int VolumeCountOf(absl::Span<const PlaneLink> links) {
  int count = kVolumesPerLink * static_cast<int>(links.size());
  for (const PlaneLink& link : links) count += link.is_branch ? 1 : 0;
  return count;
}

absl::Status CheckPlaneLinks(absl::Span<const PlaneLink> links) {
  Violations violations;
  const int count = static_cast<int>(links.size());
  for (int i = 0; i < count; ++i) {
    const PlaneLink& link = links[i];
    const std::string field = absl::StrCat("links[", i, "]");
    if (link.parent < -1 || link.parent >= i) {
      violations.Add(field + ".parent",
                     absl::StrCat("want -1 to ", i - 1, ", got ", link.parent));
    }
    if (link.continuation < -1 || link.continuation >= count) {
      violations.Add(
          field + ".continuation",
          absl::StrCat("want -1 to ", count - 1, ", got ", link.continuation));
    }
    for (const auto& [name, number] :
         {std::pair(".length_m", link.length_m),
          {".start_spacing_m", link.start_spacing_m},
          {".end_spacing_m", link.end_spacing_m}}) {
      if (std::isfinite(number) && number > 0) continue;
      violations.Add(absl::StrCat(field, name),
                     absl::StrCat("want more than 0 m, got ", number));
    }
  }
  return violations.ToStatus();
}

absl::Status DecodeControlPlanes(const VolumeRig& rig, absl::string_view bytes,
                                 std::vector<BezierVolume>& volumes) {
  return DecodeControlPlanes(PlaneLinksOf(rig), bytes, volumes);
}

absl::Status DecodeControlPlanes(absl::Span<const PlaneLink> links,
                                 absl::string_view bytes,
                                 std::vector<BezierVolume>& volumes) {
  const absl::StatusOr<VertexStreamHeader> header = ReadHeader(bytes);
  if (!header.ok()) return header.status();
  bytes.remove_prefix(kVertexStreamHeaderBytes);
  const size_t plane_count = PlaneCount(links);
  if (header->encoding != VertexEncoding::kControlPlanes ||
      header->block_count != plane_count ||
      bytes.size() != plane_count * kPlaneBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("control planes: want ", plane_count, " planes in ",
                     plane_count * kPlaneBytes, " bytes, got ",
                     header->block_count, " in ", bytes.size()));
  }
  const int count = static_cast<int>(links.size());
  std::vector<LinkPlanes> made(count);
  for (LinkPlanes& link : made) {
    for (int k : kFreePlanes) link.planes[k] = Take(bytes);
    link.planes[3] = Middle(link.planes[2], link.planes[4]);
  }
  // Stubs are in the order of their links.
  for (int i = 0; i < count; ++i) {
    LinkPlanes& link = made[i];
    const double spacing = links[i].start_spacing_m;
    if (links[i].is_branch) {
      link.stub[0] = Take(bytes);
      link.stub[1] = Shifted(link.stub[0], spacing);
      link.stub[2] = Take(bytes);
      link.stub[3] = Middle(link.stub[2], link.planes[1]);
      link.planes[0] = link.stub[3];
    } else if (links[i].parent < 0) {
      link.planes[0] = Shifted(link.planes[1], -spacing);
    }
    if (links[i].continuation < 0) {
      link.planes[6] = Shifted(link.planes[5], links[i].end_spacing_m);
    }
  }
  for (int i = 0; i < count; ++i) {
    const int next = links[i].continuation;
    if (next < 0) continue;
    made[i].planes[6] = Middle(made[i].planes[5], made[next].planes[1]);
    made[next].planes[0] = made[i].planes[6];
  }
  volumes.resize(VolumeCountOf(links));
  int stub = kVolumesPerLink * count;
  for (int i = 0; i < count; ++i) {
    const LinkPlanes& link = made[i];
    BezierVolume* own = &volumes[kVolumesPerLink * i];
    own[0] = BezierVolume::Between({link.planes, 4});
    own[1] = BezierVolume::Between({link.planes + 3, 4});
    // Muscles scale the axes of P2 but do not turn them.
    const Vector3d s = link.planes[2].s_axis().normalized();
    const Vector3d t = link.planes[2].t_axis().normalized();
    own[2] =
        BezierVolume::Affine(ControlPlane(link.planes[0].center(), s, t),
                             ControlPlane(links[i].length_m * s.cross(t),
                                          Vector3d::Zero(), Vector3d::Zero()));
    if (links[i].is_branch) {
      volumes[stub++] = BezierVolume::Between({link.stub, kPlanesPerStub});
    }
  }
  return absl::OkStatus();
}

}  // namespace gelenk
