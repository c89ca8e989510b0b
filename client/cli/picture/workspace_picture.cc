#include "client/cli/picture/workspace_picture.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/scale_bar.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {
namespace {

constexpr double kMargin = 32;
constexpr double kTitleHeight = 84;
constexpr double kPanelSize = 340;
constexpr double kPanelPadding = 18;
constexpr double kGap = 28;
constexpr double kLegendHeight = 56;

// Steps of the colour; 0 is none.
constexpr int kShades = 6;

constexpr absl::string_view kAxisNames[] = {"X", "Y", "Z"};

Svg OpenPicture(int panels, absl::string_view title,
                absl::string_view subtitle) {
  const double width = 2 * kMargin + panels * kPanelSize + (panels - 1) * kGap;
  const double height = kTitleHeight + kPanelSize + kLegendHeight + kMargin;
  Svg svg(width, height, title, PictureStyle());
  svg.Rectangle({0, 0, width, height}, 0, "paper");
  svg.Text({kMargin, 40}, title, "title");
  svg.Text({kMargin, 62}, subtitle, "");
  return svg;
}

Box PanelBox(int panel) {
  return {kMargin + panel * (kPanelSize + kGap), kTitleHeight + 12, kPanelSize,
          kPanelSize};
}

// A projection: what is to the right, what is up, and what is looked along.
struct View {
  int right;
  int up;
  int along;
};

// The views in which the map has an area; a line of voxels still has one.
std::vector<View> ViewsOf(const WorkspaceMap& map) {
  const std::vector<View> all = {{0, 1, 2}, {2, 1, 0}, {0, 2, 1}};
  std::vector<View> views;
  for (const View& view : all) {
    if (map.size[view.right] > 1 && map.size[view.up] > 1) {
      views.push_back(view);
    }
  }
  return views.empty() ? std::vector<View>{all.front()} : views;
}

// The best manipulability behind each pixel, below 0 where nothing is.
std::vector<double> Project(const WorkspaceMap& map, const View& view) {
  std::vector<double> pixels(size_t(map.size[view.right]) * map.size[view.up],
                             -1);
  for (const ReachedVoxel& voxel : map.voxels) {
    const int at[3] = {voxel.index % map.size.x(),
                       voxel.index / map.size.x() % map.size.y(),
                       voxel.index / map.size.x() / map.size.y()};
    double& pixel =
        pixels[size_t(at[view.up]) * map.size[view.right] + at[view.right]];
    pixel = std::max(pixel, voxel.mean_manipulability);
  }
  return pixels;
}

int ShadeOf(double value, double largest) {
  if (value < 0) return 0;
  if (largest <= 0) return 1;
  return 1 + std::min(kShades - 1, static_cast<int>(kShades * value / largest));
}

std::string ShadeClass(int shade) { return absl::StrCat("shade", shade); }

// Pixels of one shade beside one another are one rectangle.
void DrawPixels(const std::vector<double>& pixels, int columns, double largest,
                const Point& lower_left, double edge, Svg& svg) {
  const int rows = static_cast<int>(pixels.size()) / columns;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns;) {
      const int shade =
          ShadeOf(pixels[size_t(row) * columns + column], largest);
      int end = column + 1;
      while (end < columns &&
             ShadeOf(pixels[size_t(row) * columns + end], largest) == shade) {
        ++end;
      }
      if (shade > 0) {
        svg.Rectangle(
            {lower_left.x() + column * edge, lower_left.y() - (row + 1) * edge,
             (end - column) * edge, edge},
            0, ShadeClass(shade));
      }
      column = end;
    }
  }
}

void DrawView(const WorkspaceMap& map, const View& view, double largest,
              const Box& box, Svg& svg) {
  svg.Text({box.left, box.top - 8},
           absl::StrCat("along ", kAxisNames[view.along], ": ",
                        kAxisNames[view.right], " to the right, ",
                        kAxisNames[view.up], " up"),
           "heading");
  svg.Rectangle(box, 6, "panel");
  const int columns = map.size[view.right];
  const int rows = map.size[view.up];
  const double edge =
      (box.width - 2 * kPanelPadding) / std::max({columns, rows, 1});
  const Point lower_left(box.center().x() - 0.5 * columns * edge,
                         box.center().y() + 0.5 * rows * edge);
  DrawPixels(Project(map, view), columns, largest, lower_left, edge, svg);
  const double pixels_per_m = edge / map.voxel_size_m;
  // The skeleton's origin, where it is on the panel.
  const Point origin(lower_left.x() - map.world_min[view.right] * pixels_per_m,
                     lower_left.y() + map.world_min[view.up] * pixels_per_m);
  if (origin.x() > box.left && origin.x() < box.right() &&
      origin.y() > box.top && origin.y() < box.bottom()) {
    svg.Circle(origin, 3.5, "effector");
  }
  DrawScaleBar(pixels_per_m, box, svg);
}

void DrawLegend(double largest, Svg& svg) {
  const double top = kTitleHeight + 12 + kPanelSize + 24;
  constexpr double kSwatch = 26;
  for (int shade = 1; shade <= kShades; ++shade) {
    svg.Rectangle({kMargin + (shade - 1) * kSwatch, top, kSwatch, 12}, 0,
                  ShadeClass(shade));
  }
  svg.Text({kMargin + kShades * kSwatch + 10, top + 10},
           absl::StrCat("manipulability, 0 to ", Significant(largest, 3)), "");
  svg.Text({kMargin, top + 30},
           "the best mean behind a pixel; the dot is the skeleton's origin",
           "");
}

}  // namespace

std::string WorkspacePictureSvg(const PlanarAnnulus& annulus,
                                absl::string_view effector) {
  Svg svg = OpenPicture(
      1, absl::StrCat("Reach of ", effector),
      absl::StrCat("exact: ", Significant(annulus.inner_radius_m, 6), " to ",
                   Significant(annulus.outer_radius_m, 6), " m"));
  const Box box = PanelBox(0);
  svg.Rectangle(box, 6, "panel");
  const double pixels_per_m =
      annulus.outer_radius_m > 0
          ? (box.width / 2 - kPanelPadding) / annulus.outer_radius_m
          : 1;
  svg.Circle(box.center(), annulus.outer_radius_m * pixels_per_m, "shade3");
  svg.Circle(box.center(), annulus.inner_radius_m * pixels_per_m, "panel");
  svg.Circle(box.center(), 3.5, "effector");
  DrawScaleBar(pixels_per_m, box, svg);
  const Eigen::Vector3d& n = annulus.world_normal;
  svg.Text(
      {box.left, box.bottom() + 20},
      absl::StrCat("seen along its normal (", Significant(n.x(), 3), ", ",
                   Significant(n.y(), 3), ", ", Significant(n.z(), 3), ")"),
      "");
  return std::move(svg).Finish();
}

std::string WorkspacePictureSvg(const WorkspaceMap& map,
                                absl::string_view effector) {
  const std::vector<View> views = ViewsOf(map);
  double largest = 0;
  for (const ReachedVoxel& voxel : map.voxels) {
    largest = std::max(largest, voxel.mean_manipulability);
  }
  Svg svg = OpenPicture(
      static_cast<int>(views.size()), absl::StrCat("Reach of ", effector),
      absl::StrCat(map.voxels.size(), " voxels of ",
                   Significant(map.voxel_size_m, 3), " m reached by ",
                   map.sample_count, " poses"));
  for (size_t i = 0; i < views.size(); ++i) {
    DrawView(map, views[i], largest, PanelBox(static_cast<int>(i)), svg);
  }
  DrawLegend(largest, svg);
  return std::move(svg).Finish();
}

}  // namespace gelenk::cli
