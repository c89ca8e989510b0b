#include "client/cli/picture/mesh_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/picture/camera.h"
#include "client/cli/picture/scale_bar.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"

namespace gelenk::cli {
namespace {

using Eigen::Vector3d;

constexpr double kMargin = 28;
constexpr double kTitleHeight = 72;
constexpr double kPanelWidth = 280;
constexpr double kCaptionHeight = 30;
constexpr double kPadding = 18;
constexpr double kGap = 14;
// A panel is at most so many times as high as it is wide.
constexpr double kMostHeight = 1.6;
// A mesh without any extent still has a scale.
constexpr double kSmallestViewM = 1e-3;
constexpr int kShades = 20;
// Of the light that comes from everywhere.
constexpr double kAmbient = 0.25;

// Classes "s0" (dark) to "s19" (bright), from one colour to another. The edge
// in the same colour hides the seams between triangles.
std::string ShadeStyle() {
  const Vector3d dark(86, 46, 38), bright(247, 214, 190);
  std::string style;
  for (int i = 0; i < kShades; ++i) {
    const Vector3d color = dark + (bright - dark) * i / (kShades - 1);
    const std::string hex =
        absl::StrFormat("#%02x%02x%02x", static_cast<int>(color[0]),
                        static_cast<int>(color[1]), static_cast<int>(color[2]));
    absl::StrAppend(&style, ".s", i, " { fill: ", hex, "; stroke: ", hex,
                    "; }\n");
  }
  return style + ".mesh { stroke-width: 0.7; stroke-linejoin: round; }\n";
}

class MeshPainter {
 public:
  MeshPainter(absl::Span<const Triangle> triangles,
              absl::Span<const MeshPanel> panels, const MeshView& view)
      : triangles_(triangles),
        panels_(panels),
        view_(view),
        camera_(view.up, view.toward_viewer),
        light_((view.toward_viewer + view.up +
                0.6 * view.toward_viewer.cross(view.up))
                   .normalized()) {
    for (const MeshPanel& panel : panels) {
      for (const Vector3d& position : panel.positions) {
        bounds_.extend(camera_.Project(position));
      }
    }
    if (bounds_.isEmpty()) bounds_.extend(Point::Zero());
    const Point size = bounds_.sizes().cwiseMax(kSmallestViewM);
    panel_height_ = std::min(
        kMostHeight * kPanelWidth,
        2 * kPadding + size.y() / size.x() * (kPanelWidth - 2 * kPadding));
    scale_ = std::min((kPanelWidth - 2 * kPadding) / size.x(),
                      (panel_height_ - 2 * kPadding) / size.y());
  }

  std::string Paint(absl::string_view title) {
    const int columns =
        std::clamp(static_cast<int>(panels_.size()), 1, view_.columns);
    const int rows = (static_cast<int>(panels_.size()) + columns - 1) / columns;
    const double cell_height = panel_height_ + kCaptionHeight + kGap;
    const double width = 2 * kMargin + columns * (kPanelWidth + kGap) - kGap;
    const double height = kTitleHeight + rows * cell_height + kMargin - kGap;
    Svg svg(width, height, title, absl::StrCat(PictureStyle(), ShadeStyle()));
    svg.Rectangle({0, 0, width, height}, 0, "paper");
    svg.Text({kMargin, 46}, title, "title");
    for (size_t i = 0; i < panels_.size(); ++i) {
      const int row = static_cast<int>(i) / columns;
      const int column = static_cast<int>(i) % columns;
      const Box box = {kMargin + column * (kPanelWidth + kGap),
                       kTitleHeight + row * cell_height, kPanelWidth,
                       panel_height_ + kCaptionHeight};
      svg.Rectangle(box, 8, "panel");
      svg.Text({box.center().x(), box.bottom() - 11}, panels_[i].caption,
               "heading middle");
      DrawMesh(panels_[i], box, svg);
      if (i == 0) DrawScaleBar(scale_, box, svg);
    }
    return std::move(svg).Finish();
  }

 private:
  struct Face {
    double depth;  // towards the viewer
    int shade;
    Point corners[3];
  };

  void DrawMesh(const MeshPanel& panel, const Box& box, Svg& svg) const {
    const Point middle(box.center().x(), box.top + panel_height_ / 2);
    std::vector<Face> faces;
    for (const Triangle& triangle : triangles_) {
      const Vector3d& a = panel.positions[triangle[0]];
      const Vector3d& b = panel.positions[triangle[1]];
      const Vector3d& c = panel.positions[triangle[2]];
      const Vector3d normal = (b - a).cross(c - a);
      if (normal.dot(view_.toward_viewer) <= 0) continue;
      const double light = std::max(0.0, normal.normalized().dot(light_));
      Face& face = faces.emplace_back();
      face.depth = view_.toward_viewer.dot(a + b + c);
      face.shade = static_cast<int>(
          std::lround((kAmbient + (1 - kAmbient) * light) * (kShades - 1)));
      for (int k = 0; k < 3; ++k) {
        face.corners[k] =
            middle + scale_ * (camera_.Project(panel.positions[triangle[k]]) -
                               bounds_.center());
      }
    }
    std::stable_sort(
        faces.begin(), faces.end(),
        [](const Face& x, const Face& y) { return x.depth < y.depth; });
    svg.OpenGroup("mesh");
    for (const Face& face : faces) {
      svg.Polygon(face.corners, absl::StrCat("s", face.shade));
    }
    svg.CloseGroup();
  }

  const absl::Span<const Triangle> triangles_;
  const absl::Span<const MeshPanel> panels_;
  const MeshView view_;
  const Camera camera_;
  const Vector3d light_;
  Eigen::AlignedBox2d bounds_;
  double panel_height_ = 0;
  double scale_ = 1;
};

}  // namespace

std::string MeshPictureSvg(absl::string_view title,
                           absl::Span<const Triangle> triangles,
                           absl::Span<const MeshPanel> panels,
                           const MeshView& view) {
  return MeshPainter(triangles, panels, view).Paint(title);
}

}  // namespace gelenk::cli
