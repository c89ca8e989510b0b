// Cleaning and timing of a session's frames: of the poses of its source, or of
// the targets of its goals.
//
// With a fill interval somebody may ask for what stands for a frame that did
// not come (InputFrame::is_fill). The moment of that is the arrival less the
// offset of the clocks (see ClockOffset), as if a frame came now by the fastest
// way. With a jitter buffer such a session times all its motion so: a frame
// that comes behind a fill, though it was captured before, is still shown when
// the buffer gets to it.
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

  bool fills() const { return options_.fill_interval_s > 0; }

  // Gives `frame`, which comes at `arrival`, its time of motion, and one that
  // nobody sent a capture time: after all before.
  void SetTimes(absl::Time arrival, InputFrame& frame) const;

  // OUT_OF_RANGE where `frame` was captured before what was shown when it did
  // not come.
  absl::Status CheckInTime(const InputFrame& frame) const;

  // Whether `frame` may be taken: it says when it was captured, and one that is
  // missing (without pose, or targets) is not the first.
  absl::Status CheckFrame(const InputFrame& frame) const;

  // A checked frame that came at `arrival`, and has its times.
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
  // When `arrival` is by the source's clock, if the way took no longer than the
  // fastest.
  absl::Duration TimeOf(absl::Time arrival, double offset_s) const;
  void ForgetTimes();

  const ConditioningOptions options_;
  FrameConditioner conditioner_;
  std::optional<TargetRig> rig_;
  // What came last, and what is used for it.
  Eigen::VectorXd newest_;
  Eigen::VectorXd used_;
  // Of the newest frame that was sent.
  std::optional<absl::Duration> capture_time_;
  // When in the motion the newest frame is, sent or not.
  std::optional<absl::Duration> motion_time_;
  // The newest capture that was shown in the place of a frame.
  std::optional<absl::Duration> shown_until_;
  // Between captures and arrivals; empty unless it fills.
  ClockOffset clock_offset_{kClockWindow_s};
  absl::Time arrival_;
  LiveStatus status_;
};

}  // namespace gelenk::server

#endif  // GELENK_SERVER_SESSION_FRAME_CONDITIONING_H_
