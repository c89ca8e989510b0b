#include "server/rpc/body_methods.h"

#include <optional>
#include <string>
#include <utility>

#include "convert/joint_map.h"
#include "convert/motion_quality.h"
#include "gelenk/base/violations.h"
#include "gelenk/retarget/moving_body.h"
#include "server/rpc/named_motion.h"
#include "server/rpc/retarget_method.h"
#include "server/rpc/unary_call.h"

namespace gelenk::server {
namespace {

using Service = v1::MotionService::AsyncService;

absl::Status MeasureClip(const ServiceState& state,
                         const v1::MeasureClipRequest& request,
                         v1::MeasureClipResponse* response) {
  absl::StatusOr<NamedMotion> motion = MotionOf(state, "clip", request.clip());
  if (!motion.ok()) return motion.status();
  auto body = BodyOf("clip", *std::move(motion));
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
    PairFrames(*body, *reference);
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
