#include "client/cli/picture/tangent_picture.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {
namespace {

constexpr double kWidth = 720;
constexpr double kHeight = 460;
constexpr Box kPlot = {60, 60, 620, 360};
constexpr int kSegments = 240;

// From the function's plane to the plot.
struct Scale {
  double lower;
  double upper;
  double bottom;
  double top;

  Point At(double x, double y) const {
    return {kPlot.left + kPlot.width * (x - lower) / (upper - lower),
            kPlot.bottom() - kPlot.height * (y - bottom) / (top - bottom)};
  }
  bool Shows(double x) const { return x >= lower && x <= upper; }
};

}  // namespace

std::string TangentPicture(const ScalarFunction& function,
                           const Newton1dResult& result, double lower,
                           double upper) {
  std::vector<std::pair<double, double>> values;
  double bottom = 0;
  double top = 0;
  for (int i = 0; i <= kSegments; ++i) {
    const double x = lower + (upper - lower) * i / kSegments;
    const double y = function(x);
    values.emplace_back(x, y);
    bottom = std::min(bottom, y);
    top = std::max(top, y);
  }
  // A constant zero still has a height.
  const double margin = std::max(0.05 * (top - bottom), 1e-9);
  const Scale scale = {lower, upper, bottom - margin, top + margin};
  std::vector<Point> curve;
  for (const auto& [x, y] : values) curve.push_back(scale.At(x, y));

  Svg svg(kWidth, kHeight, "Newton's method by its tangents", PictureStyle());
  svg.Rectangle({0, 0, kWidth, kHeight}, 0, "paper");
  svg.Text({kPlot.left, 36}, "Newton's method by its tangents", "title");
  svg.Rectangle(kPlot, 4, "panel");
  svg.Line(scale.At(lower, 0), scale.At(upper, 0), "ground");
  svg.Polyline(curve, "curve");
  for (size_t i = 0; i < result.tangents.size(); ++i) {
    const Tangent& tangent = result.tangents[i];
    if (tangent.slope == 0 || !scale.Shows(tangent.x)) continue;
    const double next =
        std::clamp(tangent.x - tangent.f / tangent.slope, lower, upper);
    const double height = tangent.f + tangent.slope * (next - tangent.x);
    svg.Line(scale.At(tangent.x, 0), scale.At(tangent.x, tangent.f),
             "tolerance");
    svg.Line(scale.At(tangent.x, tangent.f), scale.At(next, height),
             "residual");
    svg.Circle(scale.At(tangent.x, tangent.f), 3, "effector");
    // The last iterates lie on one another.
    if (i < 4) {
      svg.Text(scale.At(tangent.x, 0) + Point(0, 16), absl::StrCat("x", i),
               "middle");
    }
  }
  if (result.converged && scale.Shows(result.x)) {
    svg.Circle(scale.At(result.x, 0), 4, "path-start");
  }
  return std::move(svg).Finish();
}

}  // namespace gelenk::cli
