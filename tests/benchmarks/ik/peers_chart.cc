#include "tests/benchmarks/ik/peers_chart.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/svg.h"
#include "client/cli/text/format.h"

namespace gelenk::benchmarks {
namespace {

using cli::Box;
using cli::Fixed;
using cli::Point;
using cli::Significant;
using cli::Svg;

constexpr double kWidth = 760;
constexpr double kLeft = 190;
constexpr double kRight = 610;
constexpr double kTop = 64;
constexpr double kBar = 14;
constexpr double kBarGap = 4;
constexpr double kGroupGap = 16;
// The axis, from 1 to 1000 microseconds.
constexpr double kDecades = 3;

constexpr char kStyle[] =
    "text{font:12px sans-serif;fill:#555}"
    ".title{font-size:15px;font-weight:bold}"
    ".end{text-anchor:end}.middle{text-anchor:middle}"
    ".grid{stroke:#999;stroke-opacity:.35}"
    ".own{fill:#1b7f79}.peer{fill:#b0b7bd}";

double XOf(double us) {
  const double decade =
      std::clamp(std::log10(std::max(us, 1e-3)), 0.0, kDecades);
  return kLeft + (kRight - kLeft) * decade / kDecades;
}

bool SameGroup(const PeerFigures& a, const PeerFigures& b) {
  return a.arm == b.arm && a.start == b.start;
}

// Tops of the bars, then the bottom of the last one.
std::vector<double> Tops(const std::vector<PeerFigures>& rows) {
  std::vector<double> tops;
  double y = kTop;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && !SameGroup(rows[i - 1], rows[i])) y += kGroupGap;
    tops.push_back(y);
    y += kBar + kBarGap;
  }
  tops.push_back(y);
  return tops;
}

void DrawGrid(double bottom, Svg& svg) {
  for (int decade = 0; decade <= kDecades; ++decade) {
    const double us = std::pow(10, decade);
    svg.Line(Point(XOf(us), kTop - 8), Point(XOf(us), bottom), "grid");
    svg.Text(Point(XOf(us), kTop - 14), absl::StrCat(us, " µs"), "middle");
  }
}

}  // namespace

std::string PeersChart(const std::vector<PeerFigures>& rows) {
  const std::vector<double> tops = Tops(rows);
  Svg svg(kWidth, tops.back() + 16,
          "Mean time of inverse kinematics, by arm, start and solver", kStyle);
  svg.Text(Point(12, 24), "Mean time of a solve, share that was solved",
           "title");
  DrawGrid(tops.back(), svg);
  for (size_t i = 0; i < rows.size(); ++i) {
    const PeerFigures& row = rows[i];
    const double base = tops[i] + kBar - 3;
    if (i == 0 || !SameGroup(rows[i - 1], row)) {
      svg.Text(Point(12, base), absl::StrCat(row.arm, ", ", row.start), "");
    }
    const double end = std::max(XOf(row.figures.mean_us), kLeft + 1);
    svg.Rectangle(Box{kLeft, tops[i], end - kLeft, kBar}, 2,
                  row.solver == "gelenk" ? "own" : "peer");
    svg.Text(
        Point(end + 6, base),
        absl::StrCat(row.solver, ": ", Significant(row.figures.mean_us, 3),
                     " µs, ", Fixed(row.figures.solved_percent(), 1), " %"),
        "");
  }
  return std::move(svg).Finish();
}

}  // namespace gelenk::benchmarks
