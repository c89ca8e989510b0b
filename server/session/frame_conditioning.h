// Cleaning and timing of a session's frames: of the poses of its source, or of
// the targets of its goals.
//
// Part of a session and guarded by its mutex. Errors are absl::Status naming
// field and value; after any error all is as it was.
#ifndef GELENK_SERVER_SESSION_FRAME_CONDITIONING_H_
#define GELENK_SERVER_SESSION_FRAME_CONDITIONING_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "absl/types/span.h"
#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/target_rig.h"
#include "gelenk/motion/frame_conditioner.h"
#include "server/session/input_frame.h"

namespace gelenk::server {

class FrameConditioning {
 public:
  // Of poses of `skeleton`. Errors as FrameConditioner::Create.
  static absl::StatusOr<std::unique_ptr<FrameConditioning>> OfPoses(
      const ConditioningOptions& options,
      std::shared_ptr<const Skeleton> skeleton);
  // Of the targets of `goals`.
  static absl::StatusOr<std::unique_ptr<FrameConditioning>> OfTargets(
      const ConditioningOptions& options, absl::Span<const Goal> goals);

  // Never change: for anybody.
  const ConditioningOptions& options() const { return options_; }
  bool is_of_targets() const { return rig_.has_value(); }

  // OUT_OF_RANGE where `frame` was captured before what was filled in for it.
  absl::Status CheckInTime(const InputFrame& frame) const;

  // Whether `frame` may be taken: it says when it was captured, and one that is
  // missing (without pose, or targets) is not the first.
  absl::Status CheckFrame(const InputFrame& frame) const;

  // A checked frame that came at `arrival`.
  void Take(const InputFrame& frame, absl::Time arrival);

  // What stands for what was taken, as SourceMotion wants it, or as targets of
  // `problem`. DEADLINE_EXCEEDED where it is late and LatePolicy::kDrop.
  absl::Status Sample(Eigen::VectorXd& source_positions);
  absl::Status Sample(IkProblem& problem);

  // Of the last sample.
  const LiveStatus& status() const { return status_; }
  absl::Duration latency() const {
    return absl::Seconds(conditioner_.latency_s());
  }

  // The goals are others now. Begins anew.
  void SetGoals(absl::Span<const Goal> goals);
  void Reset();
  void Exchange(StateNumbers& state);

 private:
  FrameConditioning(FrameConditioner conditioner, std::optional<TargetRig> rig,
                    Eigen::VectorXd newest);
  bool IsMissing(const InputFrame& frame) const;
  absl::Status Sample();

  const ConditioningOptions options_;
  FrameConditioner conditioner_;
  std::optional<TargetRig> rig_;
  // What came last, and what is used for it.
  Eigen::VectorXd newest_;
  Eigen::VectorXd used_;
  // Of the newest frame.
  std::optional<absl::Duration> capture_time_;
  std::optional<absl::Duration> filled_until_;
  absl::Time arrival_;
  LiveStatus status_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_FRAME_CONDITIONING_H_
