#include "client/cli/picture/play_picture.h"

#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/picture/figure_row.h"
#include "client/cli/picture/outcome_strip.h"
#include "client/cli/picture/root_path.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "client/cli/picture/time_chart.h"
#include "client/cli/play/summary.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {
namespace {

constexpr double kWidth = 1280;
constexpr double kHeight = 800;
constexpr double kMargin = 36;

constexpr Box kFigures = {kMargin, 104, kWidth - 2 * kMargin, 330};
constexpr Box kPath = {kMargin, 478, 290, 290};
constexpr double kChartLeft = kPath.left + kPath.width + 32 + kChartLabelWidth;
constexpr double kChartWidth = kWidth - kMargin - kChartLeft;
constexpr Box kPositionChart = {kChartLeft, 478, kChartWidth, 92};
constexpr Box kRotationChart = {kChartLeft, 608, kChartWidth, 66};
constexpr Box kStrip = {kChartLeft, 694, kChartWidth, 16};

std::string Title(const Playback& playback) {
  return absl::StrCat("gelenk play: ", playback.clip_name);
}

std::string Subtitle(const Playback& playback, const Summary& summary) {
  return absl::StrFormat(
      "%d frames, %s s at %s fps  ·  %d joints, %d goals  ·  converged %s  ·  "
      "residual p50 %s mm, p99 %s mm  ·  solve p50 %s µs, p99 %s µs",
      summary.frame_count, Significant(summary.clip_duration_s, 4),
      Significant(summary.clip_fps, 4), playback.skeleton->joint_count(),
      playback.goals.size(),
      Percent(summary.converged_count, summary.answered_count),
      Significant(summary.position_mm.p50, 2),
      Significant(summary.position_mm.p99, 2),
      Significant(summary.solve_us.p50, 3),
      Significant(summary.solve_us.p99, 3));
}

std::vector<double> Scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

void DrawKeyOfFigures(Svg& svg) {
  double x = kFigures.right();
  const double y = kFigures.top - 12;
  const auto entry = [&](absl::string_view label, double symbol_width) {
    x -= 6.4 * label.size();
    svg.Text({x, y}, label, "");
    x -= symbol_width + 6;
    return x;
  };
  const double right = entry("right limbs", 18);
  svg.Line({right, y - 4}, {right + 18, y - 4}, "bone right");
  x -= 16;
  const double left = entry("left limbs", 18);
  svg.Line({left, y - 4}, {left + 18, y - 4}, "bone left");
  x -= 16;
  const double ghost = entry("pose in the clip", 18);
  svg.Line({ghost, y - 4}, {ghost + 18, y - 4}, "ghost");
  x -= 16;
  const double target = entry("target and effector", 10);
  svg.Circle({target + 5, y - 4}, 4.5, "target");
  svg.Circle({target + 5, y - 4}, 1.8, "effector");
}

// What has an orientation to reach.
std::string PosedEffectors(const Playback& playback) {
  std::vector<absl::string_view> ids;
  for (const Goal& goal : playback.goals) {
    if (!std::holds_alternative<PositionGoal>(goal.kind)) {
      ids.push_back(EffectorId(goal.kind));
    }
  }
  return absl::StrJoin(ids, ", ");
}

void DrawCharts(const Playback& playback, const Residuals& residuals,
                const Summary& summary, Svg& svg) {
  DrawTimeChart(
      {"distance of the worst effector from its target", "mm",
       Scaled(residuals.position_m, 1e3), 1e3 * playback.tolerance.position_m},
      kPositionChart, svg);
  DrawTimeChart(
      {absl::StrCat("angle of ", PosedEffectors(playback), " from the target"),
       "mrad", Scaled(residuals.rotation_rad, 1e3),
       1e3 * playback.tolerance.rotation_rad},
      kRotationChart, svg);
  svg.Text({kStrip.left - 8, kStrip.bottom() - 4}, "outcome", "end");
  DrawOutcomeStrip(playback, kStrip, svg);
  DrawTimeAxis(summary.clip_duration_s, kStrip, svg);
  DrawOutcomeKey(playback, {kChartLeft, kHeight - kMargin}, svg);
}

}  // namespace

std::string PlayPictureSvg(const Playback& playback,
                           const Residuals& residuals) {
  const Summary summary = Summarize(playback, residuals);
  Svg svg(kWidth, kHeight, Title(playback), PictureStyle());
  svg.Rectangle({0, 0, kWidth, kHeight}, 0, "paper");
  svg.Text({kMargin, 42}, playback.clip_name, "title");
  svg.Text({kMargin, 64}, Subtitle(playback, summary), "");
  DrawKeyOfFigures(svg);
  DrawFigureRow(playback, kFigures, svg);
  DrawRootPath(playback, kPath, svg);
  DrawCharts(playback, residuals, summary, svg);
  return std::move(svg).Finish();
}

std::string PlayPictureHtml(const Playback& playback,
                            const Residuals& residuals) {
  return absl::StrCat(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>",
      EscapeXml(Title(playback)),
      "</title>\n<style>body { margin: 0; } svg { display: block; max-width: "
      "100%; height: auto; margin: 0 auto; }</style>\n</head>\n<body>\n",
      PlayPictureSvg(playback, residuals), "</body>\n</html>\n");
}

}  // namespace gelenk::cli
