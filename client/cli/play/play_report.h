// What `gelenk play` says at the end.
#ifndef CLIENT_CLI_PLAY_PLAY_REPORT_H_
#define CLIENT_CLI_PLAY_PLAY_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/cli/play/limit_choice.h"
#include "client/cli/play/playback.h"
#include "client/cli/play/residuals.h"
#include "client/cli/play/summary.h"
#include "client/cli/text/format.h"
#include "gelenk/motion/first_frame.h"

namespace gelenk::cli {

struct PlayReport {
  // Outlive the report.
  const Playback* playback = nullptr;
  const Residuals* residuals = nullptr;
  const LimitedSkeleton* limits = nullptr;
  Summary summary;
  double unit_m = 0;
  std::optional<FirstFrameJump> first_frame_jump;
  // Files that were written.
  std::vector<std::string> written;
};

std::string PlayReportText(const PlayReport& report);

// Keys stay; units are in their names.
Json PlayReportJson(const PlayReport& report);

// An error when the service did not keep its word: frames answered by errors,
// poses beyond the limits, errors other than those measured. Targets that were
// not reached are none.
absl::Status CheckPlayed(const PlayReport& report);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_PLAY_REPORT_H_
