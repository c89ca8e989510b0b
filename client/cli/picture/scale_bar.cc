#include "client/cli/picture/scale_bar.h"

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"

namespace gelenk::cli {
namespace {

// 1, 2 or 5 times a power of ten, at most `length`.
double RoundLength(double length) {
  const double decade = std::pow(10.0, std::floor(std::log10(length)));
  for (double factor : {5.0, 2.0}) {
    if (factor * decade <= length) return factor * decade;
  }
  return decade;
}

std::string LengthLabel(double length_m) {
  return length_m < 1 ? absl::StrCat(length_m * 100, " cm")
                      : absl::StrCat(length_m, " m");
}

}  // namespace

void DrawScaleBar(double pixels_per_m, const Box& box, Svg& svg) {
  const double length_m = RoundLength(box.width / 3 / pixels_per_m);
  const double y = box.bottom() - 14;
  const double right = box.right() - 14;
  const double left = right - length_m * pixels_per_m;
  svg.Line({left, y}, {right, y}, "ground");
  svg.Line({left, y - 4}, {left, y + 4}, "ground");
  svg.Line({right, y - 4}, {right, y + 4}, "ground");
  svg.Text({(left + right) / 2, y - 7}, LengthLabel(length_m), "middle");
}

}  // namespace gelenk::cli
