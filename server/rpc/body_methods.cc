#include "server/rpc/body_methods.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "convert/joint_map.h"
#include "convert/motion_quality.h"
#include "gelenk/base/violations.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/retarget/floating_base.h"
#include "gelenk/retarget/moving_body.h"
#include "server/rpc/clip_creation.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/find_skeleton.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::MotionService::AsyncService;
using Overrides = std::vector<JointMapOverride>;

// A skeleton, with motion or without, that a request names.
struct NamedMotion {
  std::string skeleton_name;
  std::shared_ptr<const Skeleton> skeleton;
  // A column a frame.
  Eigen::MatrixXd frames = {};
  double frame_time_s = 0;
  // For a clip that is made on this body.
  std::shared_ptr<const BvhForm> form = nullptr;
  double unit_m = 0;
};

absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const StoredClip& stored) {
  if (absl::Status status =
          CheckFrameCount(field, stored.clip, state.options.limits);
      !status.ok()) {
    return status;
  }
  NamedMotion motion{stored.skeleton_name, stored.clip.skeleton()};
  motion.frame_time_s = FrameTimeOf(stored.clip);
  absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(stored.clip, motion.frame_time_s);
  if (!frames.ok()) return frames.status();
  motion.frames = *std::move(frames);
  motion.form = stored.form;
  motion.unit_m = stored.unit_m;
  return motion;
}

absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const std::string& clip) {
  const absl::StatusOr<StoredClip> stored = FindClip(state, field, clip);
  if (!stored.ok()) return stored.status();
  return MotionOf(state, field, *stored);
}

absl::StatusOr<NamedMotion> MotionOf(const ServiceState& state,
                                     absl::string_view field,
                                     const v1::BodySource& source) {
  switch (source.source_case()) {
    case v1::BodySource::kSkeleton: {
      const absl::StatusOr<StoredSkeleton> stored = FindSkeleton(
          state, absl::StrCat(field, ".skeleton"), source.skeleton());
      if (!stored.ok()) return stored.status();
      return NamedMotion{stored->name, stored->skeleton};
    }
    case v1::BodySource::kClip:
      return MotionOf(state, absl::StrCat(field, ".clip"), source.clip());
    case v1::BodySource::SOURCE_NOT_SET:
      break;
  }
  Violations violations;
  violations.Add(field, "want a skeleton or a clip, got neither");
  return violations.ToStatus();
}

// FAILED_PRECONDITION for a skeleton that is no body.
absl::StatusOr<MovingBody> BodyOf(absl::string_view field, NamedMotion motion,
                                  const Overrides& overrides = {}) {
  absl::StatusOr<MovingBody> body =
      MakeMovingBody(motion.skeleton, std::move(motion.frames),
                     motion.frame_time_s, overrides);
  if (body.ok()) return body;
  return absl::FailedPreconditionError(
      absl::StrCat(field, ": ", motion.skeleton_name,
                   " is no body to read: ", body.status().message()));
}

absl::Status MeasureClip(const ServiceState& state,
                         const v1::MeasureClipRequest& request,
                         v1::MeasureClipResponse* response) {
  absl::StatusOr<NamedMotion> motion = MotionOf(state, "clip", request.clip());
  if (!motion.ok()) return motion.status();
  const auto body = BodyOf("clip", *std::move(motion));
  if (!body.ok()) return body.status();
  std::optional<MovingBody> reference;
  if (!request.reference_clip().empty()) {
    absl::StatusOr<NamedMotion> source =
        MotionOf(state, "reference_clip", request.reference_clip());
    if (!source.ok()) return source.status();
    absl::StatusOr<MovingBody> read =
        BodyOf("reference_clip", *std::move(source));
    if (!read.ok()) return read.status();
    reference = *std::move(read);
  }
  const absl::StatusOr<MeasuredMotion> measured =
      MeasureBody(*body, reference ? &*reference : nullptr);
  if (!measured.ok()) {
    Violations violations;
    violations.AddStatus("reference_clip", measured.status());
    return violations.ToStatus();
  }
  convert::ToProto(measured->quality, response->mutable_quality());
  if (measured->source) {
    convert::ToProto(*measured->source, response->mutable_reference_quality());
    convert::ToProto(*measured->comparison, response->mutable_comparison());
  }
  for (const std::string& note : body->notes) response->add_notes(note);
  return absl::OkStatus();
}

// Both sides of a map that a request gives, errors below `field`.
struct BothOverrides {
  Overrides source;
  Overrides target;
};
absl::StatusOr<BothOverrides> OverridesOf(absl::string_view field,
                                          const v1::JointMap& map,
                                          const Skeleton& source,
                                          const Skeleton& target) {
  Violations violations;
  absl::StatusOr<Overrides> of_source =
      convert::FromProto(map, convert::MapSide::kSource, source);
  absl::StatusOr<Overrides> of_target =
      convert::FromProto(map, convert::MapSide::kTarget, target);
  violations.AddStatus(field, of_source.status());
  // Roles are wrong for both sides alike.
  if (of_source.ok()) violations.AddStatus(field, of_target.status());
  if (!violations.empty()) return violations.ToStatus();
  return BothOverrides{*std::move(of_source), *std::move(of_target)};
}

absl::StatusOr<JointMap> MapOf(const NamedMotion& motion,
                               const Overrides& overrides) {
  if (motion.frames.cols() == 0) {
    return ProposeJointMap(*motion.skeleton, overrides);
  }
  const ClipView view = {motion.frames, motion.frame_time_s};
  return ProposeJointMap(*motion.skeleton, overrides, &view);
}

absl::Status ProposeMap(const ServiceState& state,
                        const v1::ProposeJointMapRequest& request,
                        v1::JointMap* response) {
  const auto source = MotionOf(state, "source", request.source());
  if (!source.ok()) return source.status();
  const auto target = MotionOf(state, "target", request.target());
  if (!target.ok()) return target.status();
  const auto overrides = OverridesOf("overrides", request.overrides(),
                                     *source->skeleton, *target->skeleton);
  if (!overrides.ok()) return overrides.status();
  const auto source_map = MapOf(*source, overrides->source);
  if (!source_map.ok()) return source_map.status();
  const auto target_map = MapOf(*target, overrides->target);
  if (!target_map.ok()) return target_map.status();
  convert::ToProto({*source_map, *source->skeleton},
                   {*target_map, *target->skeleton}, response);
  return absl::OkStatus();
}

// Gives `motion` a root that moves, when it has none; a skeleton that is not
// stored has no name.
absl::Status FreeRoot(NamedMotion& motion, std::vector<std::string>& warnings) {
  absl::StatusOr<std::shared_ptr<const Skeleton>> floating =
      WithFloatingBase(motion.skeleton);
  if (!floating.ok()) return floating.status();
  if (*floating == motion.skeleton) return absl::OkStatus();
  warnings.push_back(absl::StrCat("the root of ", motion.skeleton_name,
                                  " cannot move: this is a skeleton with a "
                                  "free one"));
  motion = NamedMotion{"", *std::move(floating)};
  return absl::OkStatus();
}

absl::StatusOr<StoredClip> Retargeted(const ServiceState& state,
                                      const v1::RetargetClipRequest& request) {
  const absl::StatusOr<StoredClip> stored =
      FindClip(state, "clip", request.clip());
  if (!stored.ok()) return stored.status();
  absl::StatusOr<NamedMotion> source = MotionOf(state, "clip", *stored);
  if (!source.ok()) return source.status();
  absl::StatusOr<NamedMotion> target =
      MotionOf(state, "target", request.target());
  if (!target.ok()) return target.status();
  std::vector<std::string> warnings;
  if (absl::Status status = FreeRoot(*target, warnings); !status.ok()) {
    return status;
  }
  const auto overrides = OverridesOf("joint_map", request.joint_map(),
                                     *source->skeleton, *target->skeleton);
  if (!overrides.ok()) return overrides.status();
  const std::string target_name = target->skeleton_name;
  const std::shared_ptr<const BvhForm> form = target->form;
  const double unit_m = target->unit_m;
  if (absl::Status status =
          CheckFrameCount("target", static_cast<double>(source->frames.cols()),
                          *target->skeleton, state.options.limits);
      !status.ok()) {
    return status;
  }
  const absl::StatusOr<MovingBody> from =
      BodyOf("clip", *std::move(source), overrides->source);
  if (!from.ok()) return from.status();
  const absl::StatusOr<MovingBody> onto =
      BodyOf("target", *std::move(target), overrides->target);
  if (!onto.ok()) return onto.status();
  RetargetOptions options;
  options.place_limbs = !request.copy_rotations_only();
  options.plant_feet = options.place_limbs;
  const absl::StatusOr<Eigen::MatrixXd> positions = RetargetBody(
      *from, onto->model,
      request.without_look_ahead() ? LookAhead::kNone : LookAhead::kWholeClip,
      options);
  if (!positions.ok()) return positions.status();
  absl::StatusOr<MotionClip> clip = ClipFromFrames(
      onto->model->skeleton, *positions,
      {.name = stored->display_name, .frame_time_s = from->frame_time_s});
  if (!clip.ok()) return clip.status();
  for (const auto& [side, body] :
       {std::pair{"source: ", &*from}, std::pair{"target: ", &*onto}}) {
    for (const std::string& note : body->notes) {
      warnings.push_back(absl::StrCat(side, note));
    }
  }
  return StoredClip{.display_name = request.display_name().empty()
                                        ? stored->display_name
                                        : request.display_name(),
                    .skeleton_name = target_name,
                    .clip = *std::move(clip),
                    .form = form,
                    .unit_m = unit_m,
                    .warnings = std::move(warnings)};
}

absl::Status RetargetClip(ServiceState& state,
                          const v1::RetargetClipRequest& request,
                          v1::Clip* response) {
  if (absl::Status status =
          CheckNewClip("clip_id", request.clip_id(), request.request_id());
      !status.ok()) {
    return status;
  }
  if (const auto earlier =
          state.clips.FindRequest(kDefaultTenant, request.request_id())) {
    ToProto(*earlier, response);
    return absl::OkStatus();
  }
  absl::StatusOr<StoredClip> made = Retargeted(state, request);
  if (!made.ok()) return made.status();
  const absl::StatusOr<StoredClip> kept = StoreClip(
      state, {request.clip_id(), request.request_id()}, *std::move(made));
  if (!kept.ok()) return kept.status();
  ToProto(*kept, response);
  return absl::OkStatus();
}

}  // namespace

void ServeBodies(Service* service, ServiceState* state, IoThread* thread) {
  ServeUnary(
      service, &Service::RequestMeasureClip,
      [state](IkSolver&, const v1::MeasureClipRequest& request,
              v1::MeasureClipResponse* response) {
        return MeasureClip(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestProposeJointMap,
      [state](IkSolver&, const v1::ProposeJointMapRequest& request,
              v1::JointMap* response) {
        return ProposeMap(*state, request, response);
      },
      state, thread);
  ServeUnary(
      service, &Service::RequestRetargetClip,
      [state](IkSolver&, const v1::RetargetClipRequest& request,
              v1::Clip* response) {
        return RetargetClip(*state, request, response);
      },
      state, thread);
}

}  // namespace gelenk::server
