#include "client/cli/picture/root_path.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/camera.h"
#include "client/cli/picture/scale_bar.h"
#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk::cli {
namespace {

constexpr double kMargin = 26;
// More points than this cannot be told apart.
constexpr int kMostPoints = 400;
// A body that stands still still has a map of this size.
constexpr double kSmallestMapM = 0.5;

// m on the map, right and down.
std::vector<Point> PathOf(const Playback& playback,
                          const Eigen::MatrixXd& poses) {
  const Camera map = MapCamera(playback.skeleton->up());
  const int hips = std::max(playback.body.hips, 0);
  const int frames = static_cast<int>(poses.cols());
  const int count = std::min(frames, kMostPoints);
  WorldTransforms world_from_joints;
  std::vector<Point> path;
  for (int i = 0; i < count; ++i) {
    const int frame =
        count == 1 ? 0
                   : static_cast<int>(int64_t{frames - 1} * i / (count - 1));
    ForwardKinematics(*playback.skeleton, poses.col(frame), world_from_joints);
    path.push_back(map.Project(world_from_joints[hips].translation));
  }
  return path;
}

}  // namespace

void DrawRootPath(const Playback& playback, const Box& box, Svg& svg) {
  svg.OpenGroup("root-path");
  const int hips = std::max(playback.body.hips, 0);
  svg.Text({box.left, box.top - 10},
           absl::StrCat("path of ", playback.skeleton->joint(hips).id,
                        ", from above"),
           "heading");
  svg.Rectangle(box, 6, "panel");
  std::vector<Point> clip = PathOf(playback, playback.clip_poses);
  std::vector<Point> answers = PathOf(playback, playback.answered_poses);

  Point low = clip.front();
  Point high = clip.front();
  for (const auto* path : {&clip, &answers}) {
    for (const Point& point : *path) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }
  const Point size = (high - low).cwiseMax(kSmallestMapM);
  const double scale = std::min((box.width - 2 * kMargin) / size.x(),
                                (box.height - 2 * kMargin) / size.y());
  const Point middle = (low + high) / 2;
  for (auto* path : {&clip, &answers}) {
    for (Point& point : *path) {
      point = box.center() + scale * (point - middle);
    }
  }
  svg.Polyline(clip, "path-target");
  svg.Polyline(answers, "path");
  svg.Circle(answers.front(), 4.5, "path-start");
  svg.Circle(answers.back(), 4.5, "path-end");
  DrawScaleBar(scale, box, svg);
  svg.CloseGroup();
}

}  // namespace gelenk::cli
