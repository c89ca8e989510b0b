#include "client/cli/picture/two_link_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/scale_bar.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {
namespace {

constexpr double kWidth = 520;
constexpr double kHeight = 600;
constexpr Box kPlot = {30, 80, 460, 460};
constexpr double kPadding = 24;

// From the plane of the links to the picture: the base is in the middle.
struct Plane {
  Point base;
  double pixels_per_m;

  Point At(double x, double y) const {
    return kPlot.center() + pixels_per_m * Point(x - base.x(), base.y() - y);
  }
};

void DrawSolution(const v1::TwoLinkSolution& solution, const Plane& plane,
                  bool best, Svg& svg) {
  const Point base = plane.At(plane.base.x(), plane.base.y());
  const Point mid =
      plane.At(solution.world_mid().x(), solution.world_mid().y());
  const Point tip =
      plane.At(solution.world_tip().x(), solution.world_tip().y());
  const absl::string_view classes = best ? "bone left" : "ghost";
  svg.Line(base, mid, classes);
  svg.Line(mid, tip, classes);
  svg.Circle(mid, 4, "path-end");
  svg.Circle(tip, 4, "effector");
}

}  // namespace

std::string TwoLinkPictureSvg(const v1::PlanarTwoLink& limb,
                              const v1::SolveTwoLinkResponse& response) {
  const Point base(limb.base().x(), limb.base().y());
  const Point target(limb.target().x(), limb.target().y());
  // The reach fits, and so does a target that is not too far.
  const double radius =
      std::max(response.max_reach_m(),
               std::min((target - base).norm(), 2 * response.max_reach_m()));
  const Plane plane = {base, (kPlot.width / 2 - kPadding) / radius};
  Svg svg(kWidth, kHeight, "Two links, closed form", PictureStyle());
  svg.Rectangle({0, 0, kWidth, kHeight}, 0, "paper");
  svg.Text({kPlot.left, 40}, "Two links, closed form", "title");
  svg.Text({kPlot.left, 62},
           response.unreachable()
               ? absl::StrCat("out of reach by ",
                              Significant(response.distance_m(), 4), " m")
               : absl::StrCat(response.solutions_size(), " solution",
                              response.solutions_size() == 1 ? "" : "s"),
           "");
  svg.Rectangle(kPlot, 6, "panel");
  svg.Circle(kPlot.center(), response.max_reach_m() * plane.pixels_per_m,
             "shade1");
  svg.Circle(kPlot.center(), response.min_reach_m() * plane.pixels_per_m,
             "panel");
  for (int i = 0; i < response.solutions_size(); ++i) {
    if (i != response.best()) {
      DrawSolution(response.solutions(i), plane, false, svg);
    }
  }
  if (response.best() < response.solutions_size()) {
    DrawSolution(response.solutions(response.best()), plane, true, svg);
  }
  const Point mark = plane.At(target.x(), target.y());
  if (mark.x() >= kPlot.left && mark.x() <= kPlot.right() &&
      mark.y() >= kPlot.top && mark.y() <= kPlot.bottom()) {
    svg.Circle(mark, 7, "target");
  }
  svg.Circle(kPlot.center(), 5, "path-start");
  DrawScaleBar(plane.pixels_per_m, kPlot, svg);
  svg.Text({kPlot.left, kPlot.bottom() + 24},
           "green: base; ring: target; full: the solution to take", "");
  return std::move(svg).Finish();
}

}  // namespace gelenk::cli
