#include "client/cli/picture/figure_row.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/cli/picture/camera.h"
#include "client/cli/picture/stick_figure.h"
#include "client/cli/play/clip_goals.h"

namespace gelenk::cli {
namespace {

constexpr double kTargetRadius = 4.5;
constexpr double kEffectorRadius = 1.8;
// Shorter lines vanish between ring and dot.
constexpr double kShortestResidual = 1.0;
constexpr double kLabelHeight = 22;
constexpr double kMargin = 14;
constexpr double kSmallestGap = 14;

// The body at one frame, on the picture plane: m from where the root stands on
// the ground, right and down.
struct Figure {
  struct Line {
    Point from;
    Point to;
    BodyHalf half;
  };
  int frame = 0;
  std::vector<Line> clip_bones;
  std::vector<Line> bones;
  std::vector<Point> targets;
  std::vector<Point> effectors;
};

struct Extent {
  double left = std::numeric_limits<double>::infinity();
  double right = -std::numeric_limits<double>::infinity();
  double top = std::numeric_limits<double>::infinity();
  double bottom = -std::numeric_limits<double>::infinity();

  void Include(const Point& point) {
    left = std::min(left, point.x());
    right = std::max(right, point.x());
    top = std::min(top, point.y());
    bottom = std::max(bottom, point.y());
  }
};

// Frames with an answer, evenly spread from the first to the last.
std::vector<int> ChosenFrames(const Playback& playback) {
  std::vector<int> answered;
  for (int frame = 0; frame < playback.frame_count(); ++frame) {
    if (playback.answers[frame].answered) answered.push_back(frame);
  }
  const int count = std::min<int>(kMostFigures, answered.size());
  std::vector<int> chosen;
  for (int i = 0; i < count; ++i) {
    const size_t last = answered.size() - 1;
    chosen.push_back(answered[count == 1 ? 0 : last * i / (count - 1)]);
  }
  return chosen;
}

class FigureMaker {
 public:
  explicit FigureMaker(const Playback& playback)
      : playback_(playback),
        camera_(CameraFor(playback)),
        halves_(HalvesOf(*playback.skeleton, playback.body)) {}

  Figure Make(int frame) {
    const Skeleton& skeleton = *playback_.skeleton;
    Figure figure;
    figure.frame = frame;
    ForwardKinematics(skeleton, playback_.clip_poses.col(frame), clip_frames_);
    ForwardKinematics(skeleton, playback_.answered_poses.col(frame), frames_);
    const int hips = std::max(playback_.body.hips, 0);
    const Eigen::Vector3d& up = skeleton.up();
    const Eigen::Vector3d& at = clip_frames_[hips].translation;
    world_foot_point_ = at - at.dot(up) * up;

    figure.clip_bones = Project(BonesOf(skeleton, halves_, clip_frames_));
    figure.bones = Project(BonesOf(skeleton, halves_, frames_));
    for (const Goal& goal : playback_.goals) {
      figure.targets.push_back(
          Project(WorldFromEffector(skeleton, goal, clip_frames_).translation));
      figure.effectors.push_back(
          Project(WorldFromEffector(skeleton, goal, frames_).translation));
    }
    return figure;
  }

 private:
  Point Project(const Eigen::Vector3d& world_point) const {
    return camera_.Project(world_point - world_foot_point_);
  }

  std::vector<Figure::Line> Project(const std::vector<Bone>& bones) const {
    std::vector<Figure::Line> lines;
    lines.reserve(bones.size());
    for (const Bone& bone : bones) {
      lines.push_back(
          {Project(bone.world_from), Project(bone.world_to), bone.half});
    }
    return lines;
  }

  const Playback& playback_;
  const Camera camera_;
  const std::vector<BodyHalf> halves_;
  Eigen::Vector3d world_foot_point_ = Eigen::Vector3d::Zero();
  WorldTransforms clip_frames_;
  WorldTransforms frames_;
};

Extent ExtentOf(const Figure& figure) {
  Extent extent;
  for (const auto* lines : {&figure.bones, &figure.clip_bones}) {
    for (const Figure::Line& line : *lines) {
      extent.Include(line.from);
      extent.Include(line.to);
    }
  }
  for (const Point& target : figure.targets) extent.Include(target);
  return extent;
}

// From the plane of figures to the picture.
struct Placement {
  Point origin;
  double scale = 1;

  Point operator()(const Point& point) const { return origin + scale * point; }
};

void DrawFigure(const Figure& figure, const Placement& place, Svg& svg) {
  svg.OpenGroup("figure");
  for (const Figure::Line& line : figure.clip_bones) {
    svg.Line(place(line.from), place(line.to), "ghost");
  }
  for (const Figure::Line& line : figure.bones) {
    svg.Line(place(line.from), place(line.to), BoneClass(line.half));
  }
  for (size_t i = 0; i < figure.targets.size(); ++i) {
    const Point target = place(figure.targets[i]);
    const Point effector = place(figure.effectors[i]);
    svg.Circle(target, kTargetRadius, "target");
    if ((target - effector).norm() > kShortestResidual) {
      svg.Line(target, effector, "residual");
    }
    svg.Circle(effector, kEffectorRadius, "effector");
  }
  svg.CloseGroup();
}

// Side by side on one ground, each as wide as it is, the gaps between them
// equal, all in one scale.
void DrawFigures(const std::vector<Figure>& figures,
                 const std::vector<Extent>& extents, double frame_time_s,
                 const Box& box, Svg& svg) {
  double top = std::numeric_limits<double>::infinity();
  double bottom = -top;
  double width = 0;
  for (const Extent& extent : extents) {
    top = std::min(top, extent.top);
    bottom = std::max(bottom, extent.bottom);
    width += extent.right - extent.left;
  }
  const double ground = box.bottom() - kMargin - kLabelHeight;
  const double room = box.width - 2 * kMargin;
  const double gaps = static_cast<double>(figures.size());
  const double scale =
      std::min((ground - box.top - kMargin) / std::max(bottom - top, 1e-6),
               (room - gaps * kSmallestGap) / std::max(width, 1e-6));
  const double gap = (room - scale * width) / gaps;

  svg.Line({box.left + kMargin, ground}, {box.right() - kMargin, ground},
           "ground");
  double left = box.left + kMargin + gap / 2;
  for (size_t i = 0; i < figures.size(); ++i) {
    const Extent& extent = extents[i];
    const Point origin(left - scale * extent.left, ground - scale * bottom);
    const double right = left + scale * (extent.right - extent.left);
    DrawFigure(figures[i], {origin, scale}, svg);
    svg.Text({(left + right) / 2, box.bottom() - kMargin},
             absl::StrFormat("%.2f s", frame_time_s * figures[i].frame),
             "middle");
    left = right + gap;
  }
}

}  // namespace

void DrawFigureRow(const Playback& playback, const Box& box, Svg& svg) {
  svg.Rectangle(box, 6, "panel");
  FigureMaker maker(playback);
  std::vector<Figure> figures;
  std::vector<Extent> extents;
  for (int frame : ChosenFrames(playback)) {
    figures.push_back(maker.Make(frame));
    extents.push_back(ExtentOf(figures.back()));
  }
  if (figures.empty()) return;
  DrawFigures(figures, extents, absl::ToDoubleSeconds(playback.frame_time), box,
              svg);
}

}  // namespace gelenk::cli
