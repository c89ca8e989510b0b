#include "server/rpc/retarget_method.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/retarget/floating_base.h"
#include "server/rpc/clip_creation.h"
#include "server/rpc/clip_message.h"
#include "server/rpc/named_motion.h"

namespace gelenk::server {
namespace {

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

}  // namespace

absl::Status RetargetClip(ServiceState& state,
                          const v1::RetargetClipRequest& request,
                          v1::Clip* response) {
  if (absl::Status status =
          CheckNewClip("clip_id", request.clip_id(), request.request_id());
      !status.ok()) {
    return status;
  }
  if (AnswerEarlier(state, request.request_id(), response)) {
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

}  // namespace gelenk::server
