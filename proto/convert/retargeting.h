// Sessions that follow another body, between the contract and the core.
#ifndef GELENK_CONVERT_RETARGETING_H_
#define GELENK_CONVERT_RETARGETING_H_

#include <memory>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/ik/instruction_set.h"
#include "gelenk/retarget/live_retargeter.h"
#include "gelenk/skeleton/skeleton.h"
#include "gelenk/v1/ik.pb.h"
#include "gelenk/v1/retargeting.pb.h"

namespace gelenk::convert {

// Numbers of a calibration's motion, about 2 MB: nine seconds of a body of 60
// joints at 120 Hz, and half of what a message may hold.
inline constexpr int kMaxCalibrationNumbers = 1 << 18;

struct RetargetedSkeletons {
  // Null with trackers.
  std::shared_ptr<const Skeleton> source;
  std::shared_ptr<const Skeleton> target;
};

// Finds who plays what and makes models of both bodies. INVALID_ARGUMENT
// listing every bad field. Cost: linear in the calibration's frames.
absl::StatusOr<LiveRetargetSpec> FromProto(const v1::Retargeting& proto,
                                           const RetargetedSkeletons& skeletons,
                                           InstructionSet level);

// All but the source's name and what is input only.
void ToProto(const LiveRetargeter& retargeter, v1::Retargeting* proto);

// What is left of a SolveReport where no goal was solved for.
void ToFollowedReport(absl::Duration duration, v1::SolveReport* proto);

// Allocates nothing once `proto` has held a report.
void ToProto(const RetargetReport& report, v1::RetargetReport* proto);

}  // namespace gelenk::convert

#endif  // GELENK_CONVERT_RETARGETING_H_
