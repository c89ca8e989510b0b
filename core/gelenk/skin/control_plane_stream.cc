#include "gelenk/skin/control_plane_stream.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "gelenk/skin/vertex_stream.h"

namespace gelenk {
namespace {

using Eigen::Vector3d;

constexpr int kFreePlanes[] = {1, 2, 4, 5};
constexpr int kFreeStubPlanes[] = {0, 2};
constexpr size_t kPlaneBytes = 9 * sizeof(float);

int PlaneCount(const VolumeRig& rig) {
  int count = static_cast<int>(std::size(kFreePlanes)) * rig.link_count();
  for (int i = 0; i < rig.link_count(); ++i) {
    if (rig.is_branch(i)) count += static_cast<int>(std::size(kFreeStubPlanes));
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
  header.block_count = PlaneCount(rig);
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

absl::Status DecodeControlPlanes(const VolumeRig& rig, absl::string_view bytes,
                                 std::vector<BezierVolume>& volumes) {
  const absl::StatusOr<VertexStreamHeader> header = ReadHeader(bytes);
  if (!header.ok()) return header.status();
  bytes.remove_prefix(kVertexStreamHeaderBytes);
  const size_t count = PlaneCount(rig);
  if (header->encoding != VertexEncoding::kControlPlanes ||
      header->block_count != count || bytes.size() != count * kPlaneBytes) {
    return absl::InvalidArgumentError(absl::StrCat(
        "control planes: want ", count, " planes in ", count * kPlaneBytes,
        " bytes, got ", header->block_count, " in ", bytes.size()));
  }
  std::vector<LinkPlanes> links(rig.link_count());
  for (LinkPlanes& link : links) {
    for (int k : kFreePlanes) link.planes[k] = Take(bytes);
    link.planes[3] = Middle(link.planes[2], link.planes[4]);
  }
  // Stubs are in the order of their links.
  for (int i = 0; i < rig.link_count(); ++i) {
    LinkPlanes& link = links[i];
    const double spacing = rig.start_spacing_m(i);
    if (rig.is_branch(i)) {
      link.stub[0] = Take(bytes);
      link.stub[1] = Shifted(link.stub[0], spacing);
      link.stub[2] = Take(bytes);
      link.stub[3] = Middle(link.stub[2], link.planes[1]);
      link.planes[0] = link.stub[3];
    } else if (rig.link(i).parent < 0) {
      link.planes[0] = Shifted(link.planes[1], -spacing);
    }
    if (rig.link(i).continuation < 0) {
      link.planes[6] = Shifted(link.planes[5], rig.end_spacing_m(i));
    }
  }
  for (int i = 0; i < rig.link_count(); ++i) {
    const int next = rig.link(i).continuation;
    if (next < 0) continue;
    links[i].planes[6] = Middle(links[i].planes[5], links[next].planes[1]);
    links[next].planes[0] = links[i].planes[6];
  }
  volumes.resize(rig.volume_count());
  for (int i = 0; i < rig.link_count(); ++i) {
    const LinkPlanes& link = links[i];
    volumes[rig.volume(i, VolumePart::kFirstHalf)] =
        BezierVolume::Between({link.planes, 4});
    volumes[rig.volume(i, VolumePart::kSecondHalf)] =
        BezierVolume::Between({link.planes + 3, 4});
    if (rig.is_branch(i)) {
      volumes[rig.volume(i, VolumePart::kStub)] =
          BezierVolume::Between({link.stub, kPlanesPerStub});
    }
    // Muscles scale the axes of P2 but do not turn them.
    const Vector3d s = link.planes[2].s_axis().normalized();
    const Vector3d t = link.planes[2].t_axis().normalized();
    volumes[rig.volume(i, VolumePart::kRigid)] =
        BezierVolume::Affine(ControlPlane(link.planes[0].center(), s, t),
                             ControlPlane(rig.link(i).length_m * s.cross(t),
                                          Vector3d::Zero(), Vector3d::Zero()));
  }
  return absl::OkStatus();
}

}  // namespace gelenk
