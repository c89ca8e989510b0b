#include "convert/conditioning.h"

#include "absl/strings/str_cat.h"
#include "convert/duration.h"
#include "gelenk/base/violations.h"

namespace gelenk::convert {
namespace {

using Kind = SmootherOptions::Kind;

void ReadFilter(const v1::StreamConditioning& proto, SmootherOptions& smoother,
                Violations& violations) {
  switch (proto.filter()) {
    case v1::StreamConditioning::FILTER_UNSPECIFIED:
      smoother.kind = Kind::kNone;
      break;
    case v1::StreamConditioning::FILTER_ONE_EURO:
      smoother.kind = Kind::kOneEuro;
      break;
    case v1::StreamConditioning::FILTER_EXPONENTIAL:
      smoother.kind = Kind::kExponential;
      break;
    default:
      violations.Add("filter", absl::StrCat("unknown value ", proto.filter()));
  }
  if (proto.has_min_cutoff_hz()) smoother.min_cutoff_hz = proto.min_cutoff_hz();
  if (proto.has_speed_coefficient()) {
    smoother.speed_coefficient = proto.speed_coefficient();
  }
  if (proto.has_time_constant()) {
    smoother.time_constant_s =
        absl::ToDoubleSeconds(FromProto(proto.time_constant()));
  }
}

v1::StreamConditioning::Filter FilterToProto(Kind kind) {
  switch (kind) {
    case Kind::kNone:
      return v1::StreamConditioning::FILTER_UNSPECIFIED;
    case Kind::kOneEuro:
      return v1::StreamConditioning::FILTER_ONE_EURO;
    case Kind::kExponential:
      return v1::StreamConditioning::FILTER_EXPONENTIAL;
  }
  return v1::StreamConditioning::FILTER_UNSPECIFIED;
}

LatePolicy ReadLatePolicy(const v1::StreamConditioning& proto,
                          Violations& violations) {
  switch (proto.late_policy()) {
    case v1::StreamConditioning::LATE_POLICY_UNSPECIFIED:
    case v1::StreamConditioning::LATE_POLICY_HOLD:
      return LatePolicy::kHold;
    case v1::StreamConditioning::LATE_POLICY_EXTRAPOLATE:
      return LatePolicy::kExtrapolate;
    case v1::StreamConditioning::LATE_POLICY_DROP:
      return LatePolicy::kDrop;
    default:
      violations.Add("late_policy",
                     absl::StrCat("unknown value ", proto.late_policy()));
      return LatePolicy::kHold;
  }
}

v1::StreamConditioning::LatePolicy LatePolicyToProto(LatePolicy policy) {
  switch (policy) {
    case LatePolicy::kHold:
      return v1::StreamConditioning::LATE_POLICY_HOLD;
    case LatePolicy::kExtrapolate:
      return v1::StreamConditioning::LATE_POLICY_EXTRAPOLATE;
    case LatePolicy::kDrop:
      return v1::StreamConditioning::LATE_POLICY_DROP;
  }
  return v1::StreamConditioning::LATE_POLICY_UNSPECIFIED;
}

}  // namespace

absl::StatusOr<ConditioningOptions> FromProto(
    const v1::StreamConditioning& proto) {
  Violations violations;
  ConditioningOptions options;
  ReadFilter(proto, options.smoother, violations);
  options.jitter_frames = proto.jitter_buffer_frames();
  options.frame_interval_s =
      absl::ToDoubleSeconds(FromProto(proto.frame_interval()));
  options.late_policy = ReadLatePolicy(proto, violations);
  if (proto.has_extrapolation_limit()) {
    options.max_extrapolation_s =
        absl::ToDoubleSeconds(FromProto(proto.extrapolation_limit()));
  }
  if (proto.has_ease_duration()) {
    options.ease_s = absl::ToDoubleSeconds(FromProto(proto.ease_duration()));
  }
  if (proto.has_fill_interval()) {
    options.fill_interval_s =
        absl::ToDoubleSeconds(FromProto(proto.fill_interval()));
    if (options.fill_interval_s == 0) {
      violations.Add("fill_interval", "want more than 0 s, or unset");
    }
  }
  if (!violations.empty()) return violations.ToStatus();
  return options;
}

void ToProto(const ConditioningOptions& options,
             v1::StreamConditioning* proto) {
  proto->set_filter(FilterToProto(options.smoother.kind));
  proto->set_min_cutoff_hz(options.smoother.min_cutoff_hz);
  proto->set_speed_coefficient(options.smoother.speed_coefficient);
  ToProto(absl::Seconds(options.smoother.time_constant_s),
          proto->mutable_time_constant());
  proto->set_jitter_buffer_frames(options.jitter_frames);
  ToProto(absl::Seconds(options.frame_interval_s),
          proto->mutable_frame_interval());
  proto->set_late_policy(LatePolicyToProto(options.late_policy));
  ToProto(absl::Seconds(options.max_extrapolation_s),
          proto->mutable_extrapolation_limit());
  ToProto(absl::Seconds(options.ease_s), proto->mutable_ease_duration());
  if (options.fill_interval_s > 0) {
    ToProto(absl::Seconds(options.fill_interval_s),
            proto->mutable_fill_interval());
  }
}

v1::FrameTiming::Source SourceToProto(LiveStatus::State state) {
  switch (state) {
    case LiveStatus::State::kEmpty:
      return v1::FrameTiming::SOURCE_UNSPECIFIED;
    case LiveStatus::State::kWaiting:
    case LiveStatus::State::kPlaying:
      return v1::FrameTiming::SOURCE_FRAMES;
    case LiveStatus::State::kHolding:
      return v1::FrameTiming::SOURCE_HELD;
    case LiveStatus::State::kExtrapolating:
      return v1::FrameTiming::SOURCE_EXTRAPOLATED;
    case LiveStatus::State::kEasing:
      return v1::FrameTiming::SOURCE_EASED;
  }
  return v1::FrameTiming::SOURCE_UNSPECIFIED;
}

}  // namespace gelenk::convert
