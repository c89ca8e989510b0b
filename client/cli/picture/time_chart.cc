#include "client/cli/picture/time_chart.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace gelenk::cli {
namespace {

// Decades shown below the tolerance at most: what is smaller is as good as 0.
constexpr int kMostDecadesBelow = 4;

struct LogScale {
  int bottom_decade = 0;
  int top_decade = 1;
  Box box;

  double Y(double value) const {
    const double decade = std::log10(std::max(value, 1e-300));
    const double part = (decade - bottom_decade) / (top_decade - bottom_decade);
    return box.bottom() - box.height * std::clamp(part, 0.0, 1.0);
  }
};

LogScale ScaleFor(const TimeChart& chart, const Box& box) {
  double smallest = chart.tolerance;
  double largest = chart.tolerance;
  for (double value : chart.values) {
    if (value <= 0) continue;
    smallest = std::min(smallest, value);
    largest = std::max(largest, value);
  }
  const int tolerance_decade =
      static_cast<int>(std::floor(std::log10(chart.tolerance)));
  LogScale scale;
  scale.box = box;
  scale.bottom_decade =
      std::clamp(static_cast<int>(std::floor(std::log10(smallest))),
                 tolerance_decade - kMostDecadesBelow, tolerance_decade - 1);
  // Room above the largest value, so that the tolerance does not lie on the
  // edge.
  scale.top_decade =
      std::max(scale.bottom_decade + 1,
               static_cast<int>(std::floor(std::log10(largest) + 1)));
  return scale;
}

std::string DecadeLabel(int decade, const std::string& unit) {
  return absl::StrCat(std::pow(10.0, decade), " ", unit);
}

void DrawGrid(const LogScale& scale, const std::string& unit, Svg& svg) {
  const int decades = scale.top_decade - scale.bottom_decade;
  const int step = decades > 4 ? 2 : 1;
  for (int decade = scale.bottom_decade; decade <= scale.top_decade;
       decade += step) {
    const double y = scale.Y(std::pow(10.0, decade));
    svg.Line({scale.box.left, y}, {scale.box.right(), y}, "grid");
    svg.Text({scale.box.left - 8, y + 4}, DecadeLabel(decade, unit), "end");
  }
}

// The worst value of each column of pixels.
std::vector<Point> Curve(const std::vector<double>& values,
                         const LogScale& scale) {
  const int columns =
      std::max(1, std::min<int>(values.size(), std::lround(scale.box.width)));
  std::vector<double> worst(columns, 0);
  for (size_t i = 0; i < values.size(); ++i) {
    double& column = worst[i * columns / values.size()];
    column = std::max(column, values[i]);
  }
  std::vector<Point> points;
  points.reserve(columns);
  for (int i = 0; i < columns; ++i) {
    points.emplace_back(scale.box.left + scale.box.width * (i + 0.5) / columns,
                        scale.Y(worst[i]));
  }
  return points;
}

// 1, 2 or 5 times a power of ten: the largest that gives at least four steps.
double RoundStep(double length) {
  const double decade = std::pow(10.0, std::floor(std::log10(length / 4)));
  for (double factor : {5.0, 2.0}) {
    if (length / (factor * decade) >= 4) return factor * decade;
  }
  return decade;
}

}  // namespace

void DrawTimeChart(const TimeChart& chart, const Box& box, Svg& svg) {
  const LogScale scale = ScaleFor(chart, box);
  svg.OpenGroup("chart");
  svg.Text({box.left, box.top - 10}, chart.heading, "heading");
  DrawGrid(scale, chart.unit, svg);
  const double y = scale.Y(chart.tolerance);
  svg.Line({box.left, y}, {box.right(), y}, "tolerance");
  svg.Text({box.right(), box.top - 10},
           absl::StrCat("tolerance ", chart.tolerance, " ", chart.unit),
           "tolerance-label end");
  svg.Polyline(Curve(chart.values, scale), "curve");
  svg.CloseGroup();
}

void DrawTimeAxis(double duration_s, const Box& box, Svg& svg) {
  if (!(duration_s > 0)) return;
  const double step = RoundStep(duration_s);
  for (int i = 0; i * step <= duration_s * (1 + 1e-9); ++i) {
    const double x = box.left + box.width * i * step / duration_s;
    svg.Line({x, box.bottom()}, {x, box.bottom() + 5}, "ground");
    svg.Text({x, box.bottom() + 19}, absl::StrCat(i * step, " s"), "middle");
  }
}

}  // namespace gelenk::cli
