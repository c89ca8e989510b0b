#include "client/cli/picture/pose_picture.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "client/cli/picture/camera.h"
#include "client/cli/picture/scale_bar.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk::cli {
namespace {

constexpr double kMargin = 32;
constexpr double kTitleHeight = 84;
constexpr double kPanelSize = 420;
constexpr double kPanelPadding = 36;
constexpr double kGap = 28;
// Half the width of a wedge at its joint, as a share of its length, and no more
// than so many pixels.
constexpr double kWedgeShare = 0.08;
constexpr double kWidestWedge = 9;
// A skeleton without any extent still has a scale.
constexpr double kSmallestViewM = 1e-3;
// Of this size across Z, m, a skeleton is flat.
constexpr double kFlat = 1e-9;

struct Link {
  Eigen::Vector3d from;
  Eigen::Vector3d to;
};

std::vector<Link> LinksOf(const Skeleton& skeleton,
                          const WorldTransforms& world_from_joints) {
  std::vector<Link> links;
  const auto has_length = [&skeleton](int joint) {
    return skeleton.joint(joint).link_length_m > 0;
  };
  for (int i = 0; i < skeleton.joint_count(); ++i) {
    const Eigen::Vector3d& origin = world_from_joints[i].translation;
    if (has_length(i)) {
      const Joint& joint = skeleton.joint(i);
      links.push_back({origin, world_from_joints[i] *
                                   Eigen::Vector3d(joint.link_length_m *
                                                   joint.link_direction)});
    }
    const int parent = skeleton.span(i).parent;
    if (parent >= 0 && !has_length(parent)) {
      links.push_back({world_from_joints[parent].translation, origin});
    }
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    const int joint = skeleton.FindJoint(effector.joint_id);
    if (has_length(joint)) continue;
    links.push_back({world_from_joints[joint].translation,
                     world_from_joints[joint] *
                         effector.joint_from_end_effector.translation});
  }
  return links;
}

bool IsFlat(const std::vector<Link>& links) {
  return std::all_of(links.begin(), links.end(), [&](const Link& link) {
    return std::abs(link.from.z() - links.front().from.z()) < kFlat &&
           std::abs(link.to.z() - links.front().from.z()) < kFlat;
  });
}

// A horizontal direction to look from.
Eigen::Vector3d FrontOf(const Eigen::Vector3d& up) {
  const Eigen::Vector3d front = std::abs(up.z()) < 0.9
                                    ? Eigen::Vector3d::UnitZ()
                                    : Eigen::Vector3d::UnitX();
  return (front - front.dot(up) * up).normalized();
}

void DrawWedge(const Point& from, const Point& to, Svg& svg) {
  const Point along = to - from;
  const double length = along.norm();
  if (length < 0.5) return;
  const double half = std::min(kWedgeShare * length, kWidestWedge);
  const Point across = half / length * Point(-along.y(), along.x());
  const Point corners[] = {from + across, to, from - across};
  svg.Polygon(corners, "shade4");
}

class View {
 public:
  View(const Camera& camera, const Box& box) : camera_(camera), box_(box) {}

  void Draw(const std::vector<Link>& links,
            absl::Span<const Eigen::Vector3d> targets, Svg& svg) {
    Fit(links, targets);
    svg.Rectangle(box_, 6, "panel");
    for (const Link& link : links) DrawWedge(At(link.from), At(link.to), svg);
    for (const Link& link : links) svg.Circle(At(link.from), 3, "path-end");
    for (const Eigen::Vector3d& target : targets) {
      svg.Circle(At(target), 6, "target");
    }
    DrawScaleBar(pixels_per_m_, box_, svg);
  }

 private:
  void Fit(const std::vector<Link>& links,
           absl::Span<const Eigen::Vector3d> targets) {
    Point low = Point::Constant(1e30);
    Point high = -low;
    const auto take = [&](const Eigen::Vector3d& point) {
      low = low.cwiseMin(camera_.Project(point));
      high = high.cwiseMax(camera_.Project(point));
    };
    for (const Link& link : links) {
      take(link.from);
      take(link.to);
    }
    for (const Eigen::Vector3d& target : targets) take(target);
    if (low.x() > high.x()) low = high = Point::Zero();
    middle_ = 0.5 * (low + high);
    pixels_per_m_ = (box_.width - 2 * kPanelPadding) /
                    std::max((high - low).maxCoeff(), kSmallestViewM);
  }

  Point At(const Eigen::Vector3d& point) const {
    return box_.center() + pixels_per_m_ * (camera_.Project(point) - middle_);
  }

  const Camera& camera_;
  const Box box_;
  Point middle_ = Point::Zero();
  double pixels_per_m_ = 1;
};

}  // namespace

std::string PosePictureSvg(const Skeleton& skeleton,
                           const Eigen::VectorXd& positions,
                           absl::Span<const Eigen::Vector3d> targets,
                           absl::string_view title) {
  WorldTransforms world_from_joints;
  ForwardKinematics(skeleton, positions, world_from_joints);
  const std::vector<Link> links = LinksOf(skeleton, world_from_joints);
  std::vector<std::pair<Camera, const char*>> views;
  if (IsFlat(links)) {
    views.push_back({Camera(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()),
                     "along Z"});
  } else {
    const Eigen::Vector3d& up = skeleton.up();
    const Eigen::Vector3d front = FrontOf(up);
    views.push_back({Camera(up, front), "from the front"});
    views.push_back({Camera(up, up.cross(front)), "from the left"});
  }
  const double width =
      2 * kMargin + views.size() * kPanelSize + (views.size() - 1) * kGap;
  const double height = kTitleHeight + kPanelSize + kMargin;
  Svg svg(width, height, title, PictureStyle());
  svg.Rectangle({0, 0, width, height}, 0, "paper");
  svg.Text({kMargin, 40}, title, "title");
  for (size_t i = 0; i < views.size(); ++i) {
    const Box box = {kMargin + i * (kPanelSize + kGap), kTitleHeight,
                     kPanelSize, kPanelSize};
    svg.Text({box.left, box.top - 8}, views[i].second, "heading");
    View(views[i].first, box).Draw(links, targets, svg);
  }
  return std::move(svg).Finish();
}

}  // namespace gelenk::cli
