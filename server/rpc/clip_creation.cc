#include "server/rpc/clip_creation.h"

#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "convert/joint_track.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/clip_skeleton.h"
#include "server/rpc/clip_import.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/find_skeleton.h"

namespace gelenk::server {
namespace {

absl::StatusOr<StoredClip> FromFile(const ServiceState& state,
                                    const v1::CreateClipRequest& request) {
  Violations violations;
  if (request.clip().tracks_size() > 0) {
    violations.Add("clip.tracks", "want none beside a file");
  }
  if (request.clip().has_base_pose()) {
    violations.Add("clip.base_pose", "want none beside a file");
  }
  if (!violations.empty()) return violations.ToStatus();
  absl::StatusOr<ClipImport> import =
      ImportClip(request.file(), state.options.limits);
  if (!import.ok()) return import.status();
  StoredClip stored{.display_name = request.clip().display_name(),
                    .skeleton_name = request.clip().skeleton(),
                    .clip = std::move(import->clip),
                    .form = std::move(import->form),
                    .unit_m = import->unit_m,
                    .warnings = std::move(import->warnings)};
  if (stored.skeleton_name.empty()) return stored;
  const absl::StatusOr<StoredSkeleton> skeleton =
      FindSkeleton(state, "clip.skeleton", stored.skeleton_name);
  if (!skeleton.ok()) return skeleton.status();
  absl::StatusOr<MotionClip> clip = OnSkeleton(stored.clip, skeleton->skeleton);
  if (!clip.ok()) {
    violations.AddStatus("clip.skeleton", clip.status());
    return violations.ToStatus();
  }
  stored.clip = *std::move(clip);
  return stored;
}

absl::StatusOr<StoredClip> FromTracks(const ServiceState& state,
                                      const v1::Clip& proto) {
  const absl::StatusOr<StoredSkeleton> skeleton =
      FindSkeleton(state, "clip.skeleton", proto.skeleton());
  if (!skeleton.ok()) return skeleton.status();
  ClipProperties properties = {.name = proto.display_name(),
                               .frame_time_s = proto.frame_time_s()};
  if (proto.has_seam_s()) properties.seam_s = proto.seam_s();
  Violations violations;
  if (proto.has_base_pose()) {
    absl::StatusOr<Eigen::VectorXd> base =
        convert::FromProto(*skeleton->skeleton, proto.base_pose());
    violations.AddStatus("clip.base_pose", base.status());
    if (base.ok()) properties.base_positions = *std::move(base);
  }
  absl::StatusOr<std::vector<JointTrack>> tracks = convert::FromProto(
      *skeleton->skeleton, proto.frame_time_s(), proto.tracks());
  violations.AddStatus("clip", tracks.status());
  if (!violations.empty()) return violations.ToStatus();
  absl::StatusOr<MotionClip> clip = MotionClip::Create(
      skeleton->skeleton, *std::move(tracks), std::move(properties));
  if (!clip.ok()) {
    violations.AddStatus("clip", clip.status());
    return violations.ToStatus();
  }
  return StoredClip{
      .display_name = proto.display_name(),
      .skeleton_name = proto.skeleton(),
      .clip = *std::move(clip),
      .warnings = {proto.warnings().begin(), proto.warnings().end()}};
}

}  // namespace

absl::StatusOr<StoredClip> StoreClip(ServiceState& state, const NewClip& named,
                                     StoredClip clip) {
  clip.create_time = absl::Now();
  if (!clip.skeleton_name.empty()) {
    return state.clips.Create(kDefaultTenant, named.id, named.request_id,
                              std::move(clip));
  }
  StoredSkeleton skeleton;
  skeleton.display_name = clip.display_name;
  skeleton.warnings = clip.warnings;
  skeleton.create_time = clip.create_time;
  skeleton.skeleton = clip.clip.skeleton();
  const absl::StatusOr<StoredSkeleton> made =
      state.skeletons.Create(kDefaultTenant, "", "", std::move(skeleton));
  if (!made.ok()) return made.status();
  clip.skeleton_name = made->name;
  absl::StatusOr<StoredClip> stored = state.clips.Create(
      kDefaultTenant, named.id, named.request_id, std::move(clip));
  if (!stored.ok() || stored->skeleton_name != made->name) {
    // Nobody knows its name; whoever guessed it may keep it.
    state.sessions
        .RemoveUnused(
            kDefaultTenant, made->name, absl::Now(),
            [&] { return state.skeletons.Delete(kDefaultTenant, made->name); })
        .IgnoreError();
  }
  return stored;
}

StoredClip MadeClip(const StoredClip& source, MotionClip clip,
                    const std::string& display_name) {
  return StoredClip{
      .display_name = display_name.empty() ? source.display_name : display_name,
      .skeleton_name = source.skeleton_name,
      .clip = std::move(clip),
      .form = source.form,
      .unit_m = source.unit_m};
}

absl::StatusOr<StoredClip> CreateClip(
    ServiceState& state, const v1::CreateClipRequest& request,
    const std::function<bool()>& is_cancelled) {
  if (absl::Status status =
          CheckNewClip("clip_id", request.clip_id(), request.request_id());
      !status.ok()) {
    return status;
  }
  if (std::optional<StoredClip> earlier =
          state.clips.FindRequest(kDefaultTenant, request.request_id())) {
    return *std::move(earlier);
  }
  absl::StatusOr<StoredClip> made = request.has_file()
                                        ? FromFile(state, request)
                                        : FromTracks(state, request.clip());
  if (!made.ok()) return made.status();
  const Limits& limits = state.options.limits;
  const size_t numbers = made->clip.ByteSize() / sizeof(double);
  if (numbers > static_cast<size_t>(limits.max_clip_numbers)) {
    Violations violations;
    violations.Add("clip", absl::StrFormat("%d numbers are more than the %d "
                                           "that a clip may have",
                                           numbers, limits.max_clip_numbers));
    return violations.ToStatus();
  }
  if (is_cancelled()) return absl::CancelledError("the client is gone");
  return StoreClip(state, {request.clip_id(), request.request_id()},
                   *std::move(made));
}

}  // namespace gelenk::server
