#include "server/rpc/input_message.h"

#include <utility>

#include "convert/conditioning.h"
#include "convert/retargeting.h"
#include "gelenk/base/violations.h"
#include "server/rpc/find_skeleton.h"

namespace gelenk::server {
namespace {

absl::Status Below(absl::string_view field, const absl::Status& status) {
  Violations violations;
  violations.AddStatus(field, status);
  return violations.ToStatus();
}

absl::StatusOr<std::unique_ptr<SourceMotion>> SourceFromProto(
    const ServiceState& state, const v1::Retargeting& proto,
    const std::shared_ptr<const Skeleton>& target,
    absl::Span<const Goal> goals) {
  if (proto.has_trackers() == !proto.source_skeleton().empty()) {
    Violations violations;
    violations.Add("retargeting", proto.has_trackers()
                                      ? "want source_skeleton or trackers, "
                                        "got both"
                                      : "want source_skeleton or trackers");
    return violations.ToStatus();
  }
  convert::RetargetedSkeletons skeletons = {nullptr, target};
  if (!proto.has_trackers()) {
    const absl::StatusOr<StoredSkeleton> source = FindSkeleton(
        state, "retargeting.source_skeleton", proto.source_skeleton());
    if (!source.ok()) return source.status();
    skeletons.source = source->skeleton;
  }
  absl::StatusOr<LiveRetargetSpec> spec =
      convert::FromProto(proto, skeletons, state.options.instruction_set);
  if (!spec.ok()) return Below("retargeting", spec.status());
  absl::StatusOr<std::unique_ptr<LiveRetargeter>> retargeter =
      LiveRetargeter::Create(*std::move(spec));
  if (!retargeter.ok()) return Below("retargeting", retargeter.status());
  auto source = std::make_unique<SourceMotion>(proto.source_skeleton(),
                                               *std::move(retargeter));
  if (absl::Status status = source->CheckGoals(goals); !status.ok()) {
    return status;
  }
  return source;
}

absl::StatusOr<std::unique_ptr<FrameConditioning>> ConditioningFromProto(
    const v1::StreamConditioning& proto, const SourceMotion* source,
    absl::Span<const Goal> goals) {
  const absl::StatusOr<ConditioningOptions> options = convert::FromProto(proto);
  if (!options.ok()) return Below("conditioning", options.status());
  auto conditioning =
      source != nullptr && !source->retargeter().takes_trackers()
          ? FrameConditioning::OfPoses(*options,
                                       source->retargeter().source().skeleton)
          : FrameConditioning::OfTargets(*options, goals);
  if (!conditioning.ok()) return Below("conditioning", conditioning.status());
  return conditioning;
}

}  // namespace

absl::StatusOr<SessionInput> InputFromProto(
    const ServiceState& state, const v1::Session& proto,
    const std::shared_ptr<const Skeleton>& target,
    absl::Span<const Goal> goals) {
  SessionInput input;
  if (proto.has_retargeting()) {
    absl::StatusOr<std::unique_ptr<SourceMotion>> source =
        SourceFromProto(state, proto.retargeting(), target, goals);
    if (!source.ok()) return source.status();
    input.source = *std::move(source);
  }
  if (proto.has_conditioning()) {
    absl::StatusOr<std::unique_ptr<FrameConditioning>> conditioning =
        ConditioningFromProto(proto.conditioning(), input.source.get(), goals);
    if (!conditioning.ok()) return conditioning.status();
    input.conditioning = *std::move(conditioning);
  }
  return input;
}

void InputToProto(const SessionInput& input, v1::Session* proto) {
  if (input.source != nullptr) {
    v1::Retargeting* retargeting = proto->mutable_retargeting();
    retargeting->set_source_skeleton(input.source->skeleton_name());
    convert::ToProto(input.source->retargeter(), retargeting);
  }
  if (input.conditioning != nullptr) {
    convert::ToProto(input.conditioning->options(),
                     proto->mutable_conditioning());
  }
}

}  // namespace gelenk::server
