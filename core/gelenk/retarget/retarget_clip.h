// Moves another body through a whole clip, with look-ahead: Retargeter's
// method, but contacts and feet are planned over the clip.
#ifndef GELENK_RETARGET_RETARGET_CLIP_H_
#define GELENK_RETARGET_RETARGET_CLIP_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/contact/contact_labels.h"
#include "gelenk/retarget/retargeter.h"

namespace gelenk {

struct RetargetedClip {
  // The target's position_count rows, one column a frame of the source's.
  Eigen::MatrixXd positions;
  // Of the source.
  ContactLabels labels;
  // By frame.
  std::vector<RetargetReport> reports;
};

// Every column of `source_positions` is a frame, `frame_time_s` after the one
// before. Errors: INVALID_ARGUMENT naming frame and field, or as
// Retargeter::Create. Cost: linear in joints and frames.
absl::StatusOr<RetargetedClip> RetargetClip(
    std::shared_ptr<const BodyModel> source,
    std::shared_ptr<const BodyModel> target,
    const Eigen::MatrixXd& source_positions, double frame_time_s,
    const RetargetOptions& options = {});

}  // namespace gelenk

#endif  // GELENK_RETARGET_RETARGET_CLIP_H_
