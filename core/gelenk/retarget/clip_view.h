// Poses one after the other.
#ifndef GELENK_RETARGET_CLIP_VIEW_H_
#define GELENK_RETARGET_CLIP_VIEW_H_

#include <Eigen/Core>

namespace gelenk {

// A column of position_count rows a frame. Must outlive its use.
struct ClipView {
  const Eigen::MatrixXd& positions;
  double frame_time_s = 1.0 / 30;
  // The frames before are none of the motion: see FindFirstFrameJump.
  int first_frame = 0;

  int frame_count() const { return static_cast<int>(positions.cols()); }
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_CLIP_VIEW_H_
