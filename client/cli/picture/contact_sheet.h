// A motion, beside the one that it was made from, as figures in a row over time
// with the contacts of their feet, and how fast planted feet slide.
#ifndef CLIENT_CLI_PICTURE_CONTACT_SHEET_H_
#define CLIENT_CLI_PICTURE_CONTACT_SHEET_H_

#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "gelenk/contact/contact_labels.h"
#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/body_pose.h"

namespace gelenk::cli {

inline constexpr int kMostSheetFigures = 12;

// One row. All that is referred to must outlive the call.
struct SheetMotion {
  std::string name;
  const BodyModel& model;
  // position_count rows, a column a frame.
  const Eigen::MatrixXd& positions;
  // Of each frame.
  absl::Span<const BodyPose> poses;
  // Canonical, m.
  double floor_m = 0;
};

// All `motions` have as many frames as `labels`, at least one. A planted heel
// or ball has a dot, one about which the foot turns a ring.
std::string ContactSheetSvg(absl::string_view title,
                            absl::Span<const SheetMotion> motions,
                            const ContactLabels& labels, double frame_time_s);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_CONTACT_SHEET_H_
