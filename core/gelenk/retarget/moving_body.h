// A skeleton and its motion understood as a body: what measuring and
// retargeting start from, wherever the frames come from.
#ifndef GELENK_RETARGET_MOVING_BODY_H_
#define GELENK_RETARGET_MOVING_BODY_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"
#include "gelenk/retarget/joint_map.h"
#include "gelenk/retarget/motion_quality.h"
#include "gelenk/retarget/retargeter.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct MovingBody {
  std::shared_ptr<const BodyModel> model;
  // A column a frame; none for a body without motion. A first frame that is no
  // part of the motion is left out.
  Eigen::MatrixXd positions;
  double frame_time_s = 0;
  // Frames that were left out at the start, and how many more, of the way out
  // of them, a filter leaves out: see CountFramesBeforeMotion.
  int left_out = 0;
  int way_frames = 0;
  // What people should know: roles that are missing, what was left out, what
  // was found out about the rig.
  std::vector<std::string> notes;

  bool has_motion() const { return positions.cols() > 0; }
};

// `frames` has position_count rows and may have no column; then `frame_time_s`
// does not matter. Errors: those of ProposeJointMap and MakeBodyModel. Cost:
// theirs.
absl::StatusOr<MovingBody> MakeMovingBody(
    std::shared_ptr<const Skeleton> skeleton, Eigen::MatrixXd frames,
    double frame_time_s, absl::Span<const JointMapOverride> overrides = {});

// The anatomical poses of a motion.
std::vector<BodyPose> BodyPosesOf(const BodyModel& model,
                                  const Eigen::MatrixXd& positions);

// Where its feet stand; the poses are its own.
ContactLabels ContactsOf(const MovingBody& body,
                         absl::Span<const BodyPose> poses);

// Makes two motions, one made from the other, begin at the same frame: where
// one has more frames because the other lacks some at the start that are no
// part of the motion, they go, and a note says how many. Other differences
// stay.
void PairFrames(MovingBody& body, MovingBody& reference);

struct MeasuredMotion {
  MotionQuality quality;
  // Beside the motion that it was made from.
  std::optional<MotionQuality> source;
  std::optional<MotionComparison> comparison;
};

// With a `reference` (may be null), paired, its contacts count and the ground
// is flat, at height 0. INVALID_ARGUMENT without motion, or where the reference
// has not as many frames of the same time. Cost: linear.
absl::StatusOr<MeasuredMotion> MeasureBody(const MovingBody& body,
                                           const MovingBody* reference);

enum class LookAhead { kNone, kWholeClip };

// The frames of `source` on the body of `target`: its position_count rows.
// Without look-ahead as a live source is retargeted. INVALID_ARGUMENT without
// motion or without anything in common.
absl::StatusOr<Eigen::MatrixXd> RetargetBody(
    const MovingBody& source, std::shared_ptr<const BodyModel> target,
    LookAhead look_ahead, const RetargetOptions& options);

}  // namespace gelenk

#endif  // GELENK_RETARGET_MOVING_BODY_H_
