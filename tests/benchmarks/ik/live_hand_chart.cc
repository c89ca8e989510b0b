#include "tests/benchmarks/ik/live_hand_chart.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/svg.h"

namespace gelenk::benchmarks {
namespace {

using cli::Box;
using cli::Point;
using cli::Svg;

constexpr double kLeft = 92;
constexpr double kTop = 92;
constexpr double kPlotWidth = 260;
constexpr double kPlotHeight = 170;
constexpr double kColumnGap = 44;
constexpr double kRowGap = 52;

constexpr char kStyle[] =
    "text{font:12px sans-serif;fill:#444}"
    "rect.paper{fill:#fff}"
    ".title{font-size:15px;font-weight:bold}"
    ".end{text-anchor:end}.middle{text-anchor:middle}"
    ".grid{stroke:#999;stroke-opacity:.3}"
    ".bound{stroke:#444;stroke-dasharray:4 3}"
    ".own{stroke:#1b7f79;stroke-width:1.8;fill:none}"
    ".other{stroke:#d0703c;stroke-width:1.1;fill:none}";

// A logarithmic scale from bottom to top of a box.
struct Scale {
  int bottom_decade;
  int top_decade;

  double Y(double value, const Box& box) const {
    const double decade = std::log10(std::max(value, 1e-300));
    const double part = (decade - bottom_decade) / (top_decade - bottom_decade);
    return box.bottom() - box.height * std::clamp(part, 0.0, 1.0);
  }
};

constexpr Scale kStepScale = {-4, 1};
constexpr Scale kDistanceScale = {-6, 0};

// Of frames that share a column of pixels the worst.
void DrawCurve(const std::vector<double>& values, const Scale& scale,
               const Box& box, const char* classes, Svg& svg) {
  const size_t columns =
      std::min(values.size(), static_cast<size_t>(box.width));
  std::vector<double> worst(columns, 0);
  for (size_t i = 0; i < values.size(); ++i) {
    double& column = worst[i * columns / values.size()];
    column = std::max(column, values[i]);
  }
  std::vector<Point> points;
  for (size_t i = 0; i < columns; ++i) {
    points.emplace_back(box.left + box.width * (i + 0.5) / columns,
                        scale.Y(worst[i], box));
  }
  svg.Polyline(points, classes);
}

void DrawGrid(const Scale& scale, const Box& box, const char* unit,
              bool labelled, Svg& svg) {
  for (int d = scale.bottom_decade; d <= scale.top_decade; ++d) {
    const double y = scale.Y(std::pow(10.0, d), box);
    svg.Line({box.left, y}, {box.right(), y}, "grid");
    if (!labelled) continue;
    svg.Text({box.left - 8, y + 4}, absl::StrCat(std::pow(10.0, d), " ", unit),
             "end");
  }
}

void DrawTime(double duration_s, const Box& box, Svg& svg) {
  for (int s = 0; s <= duration_s; s += 2) {
    const double x = box.left + box.width * s / duration_s;
    svg.Line({x, box.bottom()}, {x, box.bottom() + 4}, "grid");
    svg.Text({x, box.bottom() + 18}, absl::StrCat(s, " s"), "middle");
  }
}

void DrawHand(const HandFigures& hand, const LiveHandLegend& legend,
              double left, bool first, Svg& svg) {
  const Box steps = {left, kTop, kPlotWidth, kPlotHeight};
  const Box distances = {left, steps.bottom() + kRowGap, kPlotWidth,
                         kPlotHeight};
  svg.Text({left, kTop - 10}, absl::StrCat(hand.name, ": joint step a frame"),
           "");
  DrawGrid(kStepScale, steps, "rad", first, svg);
  const double bound = kStepScale.Y(legend.max_step_rad, steps);
  svg.Line({left, bound}, {steps.right(), bound}, "bound");
  DrawCurve(hand.other.steps_rad, kStepScale, steps, "other", svg);
  DrawCurve(hand.ours.steps_rad, kStepScale, steps, "own", svg);
  svg.Text({left, distances.top - 10},
           absl::StrCat(hand.name, ": distance to the target"), "");
  DrawGrid(kDistanceScale, distances, "m", first, svg);
  DrawCurve(hand.other.distances_m, kDistanceScale, distances, "other", svg);
  DrawCurve(hand.ours.distances_m, kDistanceScale, distances, "own", svg);
  DrawTime(hand.ours.steps_rad.size() / legend.frames_per_second, distances,
           svg);
}

void DrawLegend(const LiveHandLegend& legend, double width, Svg& svg) {
  svg.Text({12, 24}, "A hand goes straight past the reach and comes back",
           "title");
  svg.Line({12, 46}, {40, 46}, "own");
  svg.Text({48, 50}, "gelenk", "");
  svg.Line({110, 46}, {138, 46}, "other");
  svg.Text({146, 50}, legend.other, "");
  svg.Line({width - 260, 46}, {width - 232, 46}, "bound");
  svg.Text({width - 224, 50},
           absl::StrCat("max_step, ", legend.max_step_rad, " rad a frame"), "");
}

}  // namespace

std::string LiveHandChart(const std::vector<HandFigures>& hands,
                          const LiveHandLegend& legend) {
  const double width = kLeft + hands.size() * (kPlotWidth + kColumnGap);
  const double height = kTop + 2 * kPlotHeight + kRowGap + 34;
  Svg svg(width, height,
          "Joint steps and distances of two solvers that follow a hand past "
          "the reach",
          kStyle);
  svg.Rectangle(Box{0, 0, width, height}, 0, "paper");
  DrawLegend(legend, width, svg);
  for (size_t i = 0; i < hands.size(); ++i) {
    DrawHand(hands[i], legend, kLeft + i * (kPlotWidth + kColumnGap), i == 0,
             svg);
  }
  return std::move(svg).Finish();
}

}  // namespace gelenk::benchmarks
