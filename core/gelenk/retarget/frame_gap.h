// What a source does while its frames are late or lost: it goes on as it went
// for a while, holds, and is eased to rest.
//
// Rotations on the manifold. Allocates nothing from the second frame on. Not
// thread-safe.
#ifndef GELENK_RETARGET_FRAME_GAP_H_
#define GELENK_RETARGET_FRAME_GAP_H_

#include <Eigen/Core>
#include <memory>

#include "absl/status/status.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

enum class GapPolicy { kHold, kExtrapolate };

struct GapOptions {
  GapPolicy policy = GapPolicy::kHold;
  // Extrapolated motion slows down and covers, in all, what the body would have
  // done in this time.
  double extrapolation_s = 0.1;
  // From then on the body eases to rest, ...
  double hold_s = 0.5;
  // ... within this time.
  double ease_s = 1;
};

// INVALID_ARGUMENT naming each field that is negative or not finite.
absl::Status CheckGapOptions(const GapOptions& options);

class FrameGap {
 public:
  // `rest_positions` (size position_count) are those of the skeleton's
  // reference; its root stays where it is. `options` has passed
  // CheckGapOptions.
  FrameGap(std::shared_ptr<const Skeleton> skeleton,
           const ConstVectorView& rest_positions, const GapOptions& options);

  // A frame that came, `dt_s` > 0 after the one before it; checked positions.
  void Take(const ConstVectorView& positions, double dt_s);

  // The pose to use instead of a frame that did not come, `dt_s` after the pose
  // before. There has been a frame.
  const Eigen::VectorXd& Fill(double dt_s);

  bool has_frame() const { return frame_count_ > 0; }
  // Since the last frame that came.
  double gap_s() const { return gap_s_; }
  void Reset() { frame_count_ = 0; }

 private:
  std::shared_ptr<const Skeleton> skeleton_;
  GapOptions options_;
  Eigen::VectorXd rest_;
  Eigen::VectorXd last_;
  // Per second.
  Eigen::VectorXd velocity_;
  Eigen::VectorXd step_;
  Eigen::VectorXd held_;
  Eigen::VectorXd filled_;
  int frame_count_ = 0;
  double gap_s_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_FRAME_GAP_H_
