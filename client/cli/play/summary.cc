#include "client/cli/play/summary.h"

#include <algorithm>
#include <cmath>

namespace gelenk::cli {
namespace {

void CountOutcome(SolveOutcome outcome, Summary& summary) {
  switch (outcome) {
    case SolveOutcome::kConverged:
      ++summary.converged_count;
      return;
    case SolveOutcome::kUnreachable:
      ++summary.unreachable_count;
      return;
    case SolveOutcome::kStalledAtLimits:
      ++summary.stalled_count;
      return;
    // Gave up, be it for the number of iterations, the time or the method.
    case SolveOutcome::kIterationLimit:
    case SolveOutcome::kTimeLimit:
    case SolveOutcome::kSingular:
      ++summary.iteration_limit_count;
      return;
  }
}

double PerSecond(double count, absl::Duration duration) {
  return duration > absl::ZeroDuration()
             ? count / absl::ToDoubleSeconds(duration)
             : 0;
}

}  // namespace

Quantiles QuantilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  // Nearest rank: the smallest value that so many are at most.
  const auto at = [&values](double share) {
    const double rank = std::ceil(share * static_cast<double>(values.size()));
    return values[static_cast<size_t>(std::max(rank, 1.0)) - 1];
  };
  return {at(0.5), at(0.99), values.back()};
}

Summary Summarize(const Playback& playback, const Residuals& residuals) {
  Summary summary;
  summary.frame_count = playback.frame_count();
  summary.reconnects = playback.reconnects;
  std::vector<double> position_mm;
  std::vector<double> rotation_mrad;
  std::vector<double> solve_us;
  for (int frame = 0; frame < playback.frame_count(); ++frame) {
    const Answer& answer = playback.answers[frame];
    if (!answer.error.empty()) ++summary.error_count;
    if (!answer.answered) continue;
    ++summary.answered_count;
    summary.merged_count += answer.merged_frame_count;
    CountOutcome(answer.outcome, summary);
    position_mm.push_back(1e3 * residuals.position_m[frame]);
    rotation_mrad.push_back(1e3 * residuals.rotation_rad[frame]);
    solve_us.push_back(absl::ToDoubleMicroseconds(answer.solve_duration));
  }
  if (summary.answered_count > 0) {
    summary.converged_share =
        static_cast<double>(summary.converged_count) / summary.answered_count;
  }
  summary.clip_duration_s =
      absl::ToDoubleSeconds(playback.frame_time) * summary.frame_count;
  summary.clip_fps = PerSecond(1, playback.frame_time);
  summary.played_fps = PerSecond(summary.answered_count, playback.elapsed);
  summary.position_mm = QuantilesOf(std::move(position_mm));
  summary.rotation_mrad = QuantilesOf(std::move(rotation_mrad));
  summary.solve_us = QuantilesOf(std::move(solve_us));
  const RoundTrip& round_trip = playback.round_trip;
  summary.round_trip_us = {absl::ToDoubleMicroseconds(round_trip.p50),
                           absl::ToDoubleMicroseconds(round_trip.p99),
                           absl::ToDoubleMicroseconds(round_trip.max)};
  return summary;
}

}  // namespace gelenk::cli
