// A played clip in numbers.
#ifndef CLIENT_CLI_PLAY_SUMMARY_H_
#define CLIENT_CLI_PLAY_SUMMARY_H_

#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/play/playback.h"
#include "client/cli/play/residuals.h"

namespace gelenk::cli {

// Half of the values are at most p50, 99 of 100 at most p99; 0 without values.
struct Quantiles {
  double p50 = 0;
  double p99 = 0;
  double max = 0;
};
Quantiles QuantilesOf(std::vector<double> values);

struct Summary {
  int frame_count = 0;
  int answered_count = 0;
  int error_count = 0;
  // Merged into later frames, as the answers tell.
  int64_t merged_count = 0;
  int64_t reconnects = 0;

  int converged_count = 0;
  int stalled_count = 0;
  int unreachable_count = 0;
  int iteration_limit_count = 0;
  // Of the frames with an answer.
  double converged_share = 0;

  double clip_duration_s = 0;
  double clip_fps = 0;
  double played_fps = 0;

  // The worst goal of each frame, measured on this side.
  Quantiles position_mm;
  Quantiles rotation_mrad;
  Quantiles solve_us;
  Quantiles round_trip_us;
};

Summary Summarize(const Playback& playback, const Residuals& residuals);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PLAY_SUMMARY_H_
