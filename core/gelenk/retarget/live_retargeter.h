// Retargeting at the end of a stream: frames come when they come, some are
// merged, and what is remembered can be taken elsewhere.
//
//   NoteFrame(time) ... Step(source pose, or trackers) -> positions()
//
// The time between two steps is that between the captures of their newest
// frames where both say when that was, else `frame_time_s` for every frame.
// After a gap of more than Retargeter::kMaxFrameTime_s the motion begins anew.
//
// Added latency: none. A warm frame allocates nothing. Not thread-safe.
#ifndef GELENK_RETARGET_LIVE_RETARGETER_H_
#define GELENK_RETARGET_LIVE_RETARGETER_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/retargeter.h"
#include "gelenk/retarget/tracker_body.h"

namespace gelenk {

// A person who wears trackers.
struct TrackedPerson {
  double height_m = kHumanoidHeightM;
  // See TrackerBody::Calibrate; canonical.
  std::optional<TrackerFrame> t_pose;
};

struct LiveRetargetSpec {
  // Null with trackers: the source is then the person's humanoid.
  std::shared_ptr<const BodyModel> source;
  std::optional<TrackedPerson> trackers;
  std::shared_ptr<const BodyModel> target;
  RetargetOptions options;
  // > 0, at most Retargeter::kMaxFrameTime_s.
  double frame_time_s = 1.0 / 60;
};

class LiveRetargeter {
 public:
  // Errors: INVALID_ARGUMENT naming `frame_time_s`, `options.root_scale`,
  // `trackers.height_m` or the joint map.
  static absl::StatusOr<std::unique_ptr<LiveRetargeter>> Create(
      LiveRetargetSpec spec);

  bool takes_trackers() const { return trackers_ != nullptr; }
  const LiveRetargetSpec& spec() const { return spec_; }
  const BodyModel& source() const { return retargeter_->source(); }
  const BodyModel& target() const { return retargeter_->target(); }

  // As CheckPositions of the source's skeleton.
  absl::Status CheckPose(VectorView source_positions) const;
  // INVALID_ARGUMENT naming "capture_time" when it is not after the one before.
  absl::Status CheckTime(std::optional<absl::Duration> capture_time) const;
  // Without a head, now or before, trackers tell nothing.
  bool KnowsHead() const { return trackers_->KnowsHead(); }

  // A frame came, its time checked.
  void NoteFrame(std::optional<absl::Duration> capture_time);

  // Moves the target after the source, which is checked.
  void Step(const ConstVectorView& source_positions);
  void Step(const TrackerFrame& trackers);

  // Of the target.
  const Eigen::VectorXd& positions() const { return retargeter_->positions(); }
  const RetargetReport& report() const { return retargeter_->report(); }

  // The next frame is a first one.
  void Reset();
  // The next frame is by another clock.
  void ForgetTime() {
    newest_.reset();
    stepped_.reset();
  }

  // All that the next steps depend on, but positions(): who reads a state sets
  // those of the same moment. Of frames since the last step nothing.
  void Exchange(StateNumbers& state);
  void SetPositions(const ConstVectorView& positions) {
    retargeter_->SetPositions(positions);
  }

  // Bytes beside models, about.
  size_t ByteSize() const;

 private:
  LiveRetargeter(LiveRetargetSpec spec, std::unique_ptr<TrackerBody> trackers,
                 std::unique_ptr<Retargeter> retargeter);
  // Since the step before; resets where that is too long ago.
  double NextFrameTime();

  LiveRetargetSpec spec_;
  std::unique_ptr<TrackerBody> trackers_;
  std::unique_ptr<Retargeter> retargeter_;
  // Capture of the newest frame, and of the one that was stepped to.
  std::optional<absl::Duration> newest_;
  std::optional<absl::Duration> stepped_;
  // Since the last step.
  int frame_count_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_LIVE_RETARGETER_H_
