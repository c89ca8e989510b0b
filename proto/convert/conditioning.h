// Cleaning and timing of frames between the contract and the core.
#ifndef GELENK_CONVERT_CONDITIONING_H_
#define GELENK_CONVERT_CONDITIONING_H_

#include "absl/status/statusor.h"
#include "gelenk/motion/frame_conditioner.h"
#include "gelenk/v1/conditioning.pb.h"

namespace gelenk::convert {

// INVALID_ARGUMENT for enums that name nothing; the rest is checked by
// FrameConditioner.
absl::StatusOr<ConditioningOptions> FromProto(
    const v1::StreamConditioning& proto);
void ToProto(const ConditioningOptions& options, v1::StreamConditioning* proto);

v1::FrameTiming::Source SourceToProto(LiveStatus::State state);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_CONDITIONING_H_
