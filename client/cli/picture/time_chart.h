// A quantity over time, on a logarithmic scale, against its tolerance.
#ifndef CLIENT_CLI_PICTURE_TIME_CHART_H_
#define CLIENT_CLI_PICTURE_TIME_CHART_H_

#include <string>
#include <vector>

#include "client/cli/picture/svg.h"

namespace gelenk::cli {

struct TimeChart {
  std::string heading;
  std::string unit;
  // One a frame, in that unit; not above 0 draws at the bottom.
  std::vector<double> values;
  double tolerance = 0;
};

// Room to the left of a chart for its labels.
inline constexpr double kChartLabelWidth = 58;

// `box` is the plot, without headings and labels. Every frame shows: of those
// that share a column of pixels the worst.
void DrawTimeChart(const TimeChart& chart, const Box& box, Svg& svg);

// Round times below a plot that spans `duration_s`.
void DrawTimeAxis(double duration_s, const Box& box, Svg& svg);

}  // namespace gelenk::cli

#endif  // CLIENT_CLI_PICTURE_TIME_CHART_H_
