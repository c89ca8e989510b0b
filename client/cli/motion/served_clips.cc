#include "client/cli/motion/served_clips.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/string_view.h"
#include "client/cli/file_bytes.h"
#include "client/cli/gltf_path.h"
#include "client/cli/patient_call.h"
#include "client/cli/skeleton_file.h"
#include "client/cli/unique_id.h"
#include "convert/joint_track.h"
#include "convert/motion_quality.h"
#include "convert/pose.h"
#include "convert/skeleton.h"
#include "gelenk/client/status.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk::cli {
namespace {

using Stub = v1::MotionService::Stub;

// A quarter of what a message may hold.
constexpr size_t kPieceBytes = size_t{1} << 20;

absl::StatusOr<v1::Clip> SendInPieces(client::Connection& connection,
                                      const v1::CreateClipRequest& header,
                                      absl::string_view data) {
  grpc::ClientContext context;
  connection.Prepare(PatientCall(), context);
  v1::Clip clip;
  const auto writer = connection.motion().UploadClip(&context, &clip);
  v1::UploadClipRequest piece;
  *piece.mutable_header() = header;
  bool sent = writer->Write(piece);
  piece.clear_header();
  for (size_t at = 0; sent && at < data.size(); at += kPieceBytes) {
    piece.set_data(std::string(data.substr(at, kPieceBytes)));
    sent = writer->Write(piece);
  }
  writer->WritesDone();
  // Says why where a piece was not taken.
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return client::FromGrpc(status);
  return clip;
}

// A long track comes in pieces.
void Append(v1::JointTrack track, v1::Clip& clip) {
  auto* tracks = clip.mutable_tracks();
  if (!tracks->empty()) {
    v1::JointTrack* last = tracks->Mutable(tracks->size() - 1);
    if (last->joint_id() == track.joint_id() && last->part() == track.part()) {
      last->mutable_times_s()->MergeFrom(track.times_s());
      last->mutable_values()->MergeFrom(track.values());
      last->mutable_in_tangents()->MergeFrom(track.in_tangents());
      last->mutable_out_tangents()->MergeFrom(track.out_tangents());
      return;
    }
  }
  *tracks->Add() = std::move(track);
}

}  // namespace

absl::StatusOr<v1::ClipFormat> ClipFormatOf(const std::string& path) {
  if (absl::EndsWithIgnoreCase(path, ".bvh")) return v1::CLIP_FORMAT_BVH;
  if (absl::EndsWithIgnoreCase(path, ".gltf")) return v1::CLIP_FORMAT_GLTF;
  if (absl::EndsWithIgnoreCase(path, ".glb")) return v1::CLIP_FORMAT_GLB;
  return InFile(path,
                absl::InvalidArgumentError("want a .bvh, .gltf or .glb file"));
}

absl::StatusOr<std::unique_ptr<ServedClips>> ServedClips::Open(
    const std::string& server) {
  absl::StatusOr<std::unique_ptr<Service>> service = Service::Open(server);
  if (!service.ok()) return service.status();
  return std::unique_ptr<ServedClips>(new ServedClips(*std::move(service)));
}

ServedClips::ServedClips(std::unique_ptr<Service> service)
    : service_(std::move(service)) {}

ServedClips::~ServedClips() {
  // What cannot be deleted now is of no harm to the command's result. Skeletons
  // go behind the clips that are of them.
  client::Connection& connection = *service_->connection();
  for (const std::string& name : clips_) {
    v1::DeleteClipRequest request;
    request.set_name(name);
    connection.Call(&Stub::DeleteClip, request).IgnoreError();
  }
  for (const std::string& name : skeletons_) {
    v1::DeleteSkeletonRequest request;
    request.set_name(name);
    connection.Call(&v1::KinematicsService::Stub::DeleteSkeleton, request)
        .IgnoreError();
  }
}

absl::StatusOr<v1::Clip> ServedClips::Keep(absl::StatusOr<v1::Clip> made) {
  if (!made.ok()) return made;
  clips_.insert(made->name());
  // One that comes with the server stays all the same.
  skeletons_.insert(made->skeleton());
  return made;
}

absl::StatusOr<v1::Clip> ServedClips::Upload(const std::string& path,
                                             const MotionFileOptions& options) {
  const absl::StatusOr<v1::ClipFormat> format =
      IsGlbPath(path) ? v1::CLIP_FORMAT_GLB : ClipFormatOf(path);
  if (!format.ok()) return format.status();
  v1::CreateClipRequest header;
  header.set_clip_id(UniqueId());
  header.set_request_id(header.clip_id());
  header.mutable_clip()->set_display_name(BaseName(path));
  v1::ClipFile* file = header.mutable_file();
  file->set_format(*format);
  if (options.unit_m) file->set_unit_m(*options.unit_m);
  if (!options.animation.empty()) {
    const absl::StatusOr<MotionFile> motion = ReadMotionFile(path, options);
    if (!motion.ok()) return motion.status();
    file->set_animation_index(motion->animation_index);
  }
  const absl::StatusOr<std::string> bytes = ReadFile(path);
  if (!bytes.ok()) return bytes.status();
  absl::StatusOr<v1::Clip> made =
      Keep(SendInPieces(*service_->connection(), header, *bytes));
  if (!made.ok()) return InFile(path, made.status());
  return made;
}

absl::StatusOr<std::string> ServedClips::Upload(const Skeleton& skeleton) {
  v1::CreateSkeletonRequest request;
  request.set_skeleton_id(UniqueId());
  request.set_request_id(request.skeleton_id());
  convert::ToProto(skeleton, request.mutable_skeleton());
  const absl::StatusOr<v1::Skeleton> made = service_->connection()->Call(
      &v1::KinematicsService::Stub::CreateSkeleton, request);
  if (!made.ok()) return made.status();
  skeletons_.insert(made->name());
  return made->name();
}

absl::StatusOr<v1::Clip> ServedClips::Process(const std::string& clip,
                                              std::vector<v1::ClipStep> steps) {
  v1::ProcessClipRequest request;
  request.set_clip(clip);
  for (v1::ClipStep& step : steps) *request.add_steps() = std::move(step);
  request.set_clip_id(UniqueId());
  request.set_request_id(request.clip_id());
  return Keep(
      service_->connection()->Call(&Stub::ProcessClip, request, PatientCall()));
}

absl::StatusOr<v1::Clip> ServedClips::Retarget(
    const v1::RetargetClipRequest& request) {
  v1::RetargetClipRequest named = request;
  named.set_clip_id(UniqueId());
  named.set_request_id(named.clip_id());
  return Keep(
      service_->connection()->Call(&Stub::RetargetClip, named, PatientCall()));
}

absl::StatusOr<MeasuredMotion> ServedClips::Measure(
    const std::string& clip, const std::string& reference) {
  v1::MeasureClipRequest request;
  request.set_clip(clip);
  request.set_reference_clip(reference);
  const absl::StatusOr<v1::MeasureClipResponse> response =
      service_->connection()->Call(&Stub::MeasureClip, request, PatientCall());
  if (!response.ok()) return response.status();
  MeasuredMotion measured;
  measured.quality = convert::FromProto(response->quality());
  if (response->has_comparison()) {
    measured.source = convert::FromProto(response->reference_quality());
    measured.comparison = convert::FromProto(response->comparison());
  }
  return measured;
}

absl::StatusOr<ServedClips::Exported> ServedClips::Export(
    const std::string& clip, v1::ClipFormat format) {
  v1::ExportClipRequest request;
  request.set_name(clip);
  request.set_format(format);
  grpc::ClientContext context;
  service_->connection()->Prepare(PatientCall(), context);
  const auto reader =
      service_->connection()->motion().ExportClip(&context, request);
  Exported exported;
  v1::ExportClipResponse response;
  while (reader->Read(&response)) {
    if (response.has_clip()) exported.clip = response.clip();
    exported.data += response.data();
    for (v1::JointTrack& track : *response.mutable_tracks()) {
      Append(std::move(track), exported.clip);
    }
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return client::FromGrpc(status);
  return exported;
}

absl::StatusOr<Eigen::MatrixXd> ServedClips::Frames(
    const std::string& clip, std::shared_ptr<const Skeleton> skeleton) {
  const absl::StatusOr<Exported> exported =
      Export(clip, v1::CLIP_FORMAT_UNSPECIFIED);
  if (!exported.ok()) return exported.status();
  const v1::Clip& sent = exported->clip;
  absl::StatusOr<std::vector<JointTrack>> tracks =
      convert::FromProto(*skeleton, sent.frame_time_s(), sent.tracks());
  if (!tracks.ok()) return tracks.status();
  ClipProperties properties = {.frame_time_s = sent.frame_time_s()};
  if (sent.has_base_pose()) {
    absl::StatusOr<Eigen::VectorXd> base =
        convert::FromProto(*skeleton, sent.base_pose());
    if (!base.ok()) return base.status();
    properties.base_positions = *std::move(base);
  }
  const absl::StatusOr<MotionClip> motion = MotionClip::Create(
      std::move(skeleton), *std::move(tracks), std::move(properties));
  if (!motion.ok()) return motion.status();
  return FramesFromClip(*motion);
}

absl::Status ServedClips::Write(const std::string& clip,
                                const std::string& path) {
  const absl::StatusOr<v1::ClipFormat> format = ClipFormatOf(path);
  if (!format.ok()) return format.status();
  const absl::StatusOr<Exported> exported = Export(clip, *format);
  if (!exported.ok()) return InFile(path, exported.status());
  return WriteFile(path, exported->data);
}

}  // namespace gelenk::cli
