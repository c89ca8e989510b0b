#include "server/rpc/skin_frames.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "convert/skin_layout.h"
#include "gelenk/base/violations.h"
#include "gelenk/skin/control_plane_stream.h"
#include "server/rpc/skin_building.h"
#include "server/session/revision_name.h"

namespace gelenk::server {

absl::StatusOr<std::unique_ptr<SkinFrames>> SkinFrames::Create(
    StoredSkin stored, const SkinFrameOptions& options,
    ParallelFor parallel_for) {
  Violations violations;
  const v1::VertexEncoding encoding =
      options.encoding == v1::VERTEX_ENCODING_UNSPECIFIED
          ? v1::VERTEX_ENCODING_QUANTIZED_16_OCT_8
          : options.encoding;
  if (!v1::VertexEncoding_IsValid(encoding)) {
    violations.Add("encoding", absl::StrCat("no such encoding: ",
                                            static_cast<int>(encoding)));
  } else if (encoding == v1::VERTEX_ENCODING_CONTROL_PLANES &&
             AsLayered(*stored.revision.skin) == nullptr) {
    violations.Add("encoding", absl::StrCat(stored.name,
                                            " is no mesh in layered volumes: "
                                            "there are no control planes"));
  }
  if (options.keyframe_interval < 0) {
    violations.Add(
        "keyframe_interval",
        absl::StrCat("want 0 or more, got ", options.keyframe_interval));
  }
  if (!violations.empty()) return violations.ToStatus();
  return std::unique_ptr<SkinFrames>(new SkinFrames(
      std::move(stored), encoding, options, std::move(parallel_for)));
}

SkinFrames::SkinFrames(StoredSkin stored, v1::VertexEncoding encoding,
                       const SkinFrameOptions& options,
                       ParallelFor parallel_for)
    : stored_(std::move(stored)),
      skin_(*stored_.revision.skin),
      encoding_(encoding),
      include_warnings_(options.include_warnings),
      delta_(options.keyframe_interval == 0 ? kDefaultKeyframeInterval
                                            : options.keyframe_interval) {
  workspace_.parallel_for = std::move(parallel_for);
}

void SkinFrames::FillLayout(v1::SkinLayout* proto) const {
  proto->set_name(RevisionText(stored_.name, stored_.revision.number));
  convert::ToProto(skin_, proto);
  if (encoding_ == v1::VERTEX_ENCODING_CONTROL_PLANES) {
    convert::ToProto(*AsLayered(skin_), proto->mutable_volumes());
  }
}

void SkinFrames::Deform(const ConstVectorView& positions,
                        const RigidTransform& world_from_skeleton,
                        v1::SkinFrame* proto) {
  proto->set_encoding(encoding_);
  Encode(positions, world_from_skeleton, proto->mutable_data());
  proto->set_is_keyframe(ReadHeader(proto->data())->is_keyframe);
  if (include_warnings_) AddWarnings(proto);
}

void SkinFrames::Encode(const ConstVectorView& positions,
                        const RigidTransform& world_from_skeleton,
                        std::string* bytes) {
  switch (encoding_) {
    case v1::VERTEX_ENCODING_CONTROL_PLANES: {
      const VolumeRig& rig = *RigOf(skin_);
      rig.Evaluate(positions, world_from_skeleton, workspace_.frame);
      EncodeControlPlanes(rig, workspace_.frame, ++frame_number_, *bytes);
      return;
    }
    case v1::VERTEX_ENCODING_FLOAT32:
      skin_.Deform(positions, world_from_skeleton, workspace_, blocks_);
      EncodeFloats(blocks_, ++frame_number_, *bytes);
      return;
    default:
      break;
  }
  skin_.DeformQuantized(positions, world_from_skeleton, workspace_, quantized_);
  if (encoding_ == v1::VERTEX_ENCODING_DELTA) {
    delta_.Encode(quantized_, *bytes);
  } else {
    EncodeQuantized(quantized_, ++frame_number_, *bytes);
  }
}

void SkinFrames::AddWarnings(v1::SkinFrame* proto) const {
  const VolumeRig* rig = RigOf(skin_);
  if (rig == nullptr) return;
  const VolumeFrame& frame = workspace_.frame;
  for (const VolumeFold& fold : rig->FindFolds(frame)) {
    v1::VolumeFold* out = proto->add_folds();
    out->set_link_id(rig->link(rig->volume_link(fold.volume)).id);
    out->set_least_jacobian(fold.least_jacobian);
  }
  for (int i = 0; i < rig->link_count(); ++i) {
    if (frame.volume_scale(i) == frame.wanted_volume_scale(i)) continue;
    v1::ClampedVolume* out = proto->add_clamped_volumes();
    out->set_link_id(rig->link(i).id);
    out->set_scale(frame.volume_scale(i));
    out->set_wanted_scale(frame.wanted_volume_scale(i));
  }
}

}  // namespace gelenk::server
