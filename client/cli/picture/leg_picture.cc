#include "client/cli/picture/leg_picture.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/scale_bar.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "client/cli/text/format.h"

namespace gelenk::cli {
namespace {

using Eigen::Vector3d;

constexpr double kWidth = 1200;
constexpr double kMargin = 32;
constexpr double kTitleHeight = 102;
constexpr double kWayHeight = 300;
constexpr double kFootHeight = 250;
constexpr double kGap = 40;
constexpr double kPadding = 24;
// What is below the ground is shown so far down, as a part of the panel.
constexpr double kGroundPart = 0.8;
// Moments that are drawn: every so manieth frame.
constexpr int kWayStep = 6;
constexpr int kFootStep = 2;
// Frames before and after the foot stands.
constexpr int kFramesAround = 8;

struct Span {
  int begin = 0;
  int end = 0;
};

bool IsPlanted(const LegExample& example, int frame, int point) {
  return example.labels.frames[frame][kLeft][point] == Contact::kPlanted;
}

// The longest time that the heel stands, with some frames around it.
Span LongestStand(const LegExample& example) {
  const int count = static_cast<int>(example.labels.frames.size());
  Span longest;
  for (int begin = 0; begin < count; ++begin) {
    int end = begin;
    while (end < count && IsPlanted(example, end, kHeel)) ++end;
    if (end - begin > longest.end - longest.begin) longest = {begin, end};
    begin = end;
  }
  return {std::max(0, longest.begin - kFramesAround),
          std::min(count, longest.end + kFramesAround)};
}

// From the left, forward to the right, the ground at one height.
class SideView {
 public:
  SideView(const Box& box, double from_m, double to_m)
      : box_(box),
        from_m_(from_m),
        pixels_per_m_((box.width - 2 * kPadding) / (to_m - from_m)) {}

  Point operator()(const Vector3d& at) const {
    return {box_.left + kPadding + pixels_per_m_ * (at.z() - from_m_),
            ground() - pixels_per_m_ * at.y()};
  }
  double ground() const { return box_.top + kGroundPart * box_.height; }
  double pixels_per_m() const { return pixels_per_m_; }
  const Box& box() const { return box_; }

 private:
  Box box_;
  double from_m_;
  double pixels_per_m_;
};

std::vector<Point> FootLine(const BodyPose& pose, const SideView& view) {
  const auto& points = pose.foot_points[kLeft];
  const Point ankle = view(pose.position(BodyRole::kLeftFoot));
  return {ankle, view(points[kHeel]), view(points[kBall]), view(points[kTip])};
}

void DrawGround(const SideView& view, Svg& svg) {
  const Box& box = view.box();
  svg.Rectangle(box, 6, "panel");
  svg.Rectangle(
      {box.left, view.ground(), box.width, box.bottom() - view.ground()}, 0,
      "earth");
  svg.Line({box.left, view.ground()}, {box.right(), view.ground()}, "ground");
}

// The ways of heel and ball.
void DrawWays(const LegExample& example, const LegMotion& motion,
              const Span& span, const SideView& view, Svg& svg) {
  for (const int point : {kHeel, kBall}) {
    std::vector<Point> way;
    for (int f = span.begin; f < span.end; ++f) {
      way.push_back(view(motion.poses[f].foot_points[kLeft][point]));
    }
    svg.Polyline(way, "grid");
    for (int f = span.begin; f < span.end; ++f) {
      std::vector<Point> stand;
      for (; f < span.end && IsPlanted(example, f, point); ++f) {
        stand.push_back(way[f - span.begin]);
      }
      if (stand.empty()) continue;
      svg.Polyline(stand, "slide");
      svg.Circle(stand.front(), 2.2, "slide-end");
      svg.Circle(stand.back(), 2.2, "slide-end");
    }
  }
}

void DrawWholeWay(const LegExample& example, const LegMotion& motion,
                  const Box& box, Svg& svg) {
  const int count = static_cast<int>(motion.poses.size());
  double from = 1e30;
  double to = -from;
  for (const BodyPose& pose : motion.poses) {
    for (const Vector3d& point : pose.foot_points[kLeft]) {
      from = std::min(from, point.z());
      to = std::max(to, point.z());
    }
    from = std::min(from, pose.hip_center.z());
    to = std::max(to, pose.hip_center.z());
  }
  const SideView view(box, from, to);
  DrawGround(view, svg);
  for (int f = 0; f < count; f += kWayStep) {
    const BodyPose& pose = motion.poses[f];
    const Point leg[] = {view(pose.position(BodyRole::kLeftThigh)),
                         view(pose.position(BodyRole::kLeftShin)),
                         view(pose.position(BodyRole::kLeftFoot))};
    svg.Polyline(leg, "thin left");
    svg.Polyline(FootLine(pose, view), "thin trunk");
  }
  DrawWays(example, motion, {0, count}, view, svg);
  DrawScaleBar(view.pixels_per_m(), box, svg);
}

void DrawStand(const LegExample& example, const LegMotion& motion,
               const Box& box, Svg& svg) {
  const Span span = LongestStand(example);
  // Both pictures show the same piece of ground.
  const double middle = example.keyed.poses[(span.begin + span.end) / 2]
                            .foot_points[kLeft][kBall]
                            .z();
  const SideView view(box, middle - 0.45, middle + 0.45);
  DrawGround(view, svg);
  for (int f = span.begin; f < span.end; f += kFootStep) {
    const bool stands = IsPlanted(example, f, kHeel);
    svg.Polyline(FootLine(motion.poses[f], view),
                 stands ? "thin left" : "thin pale");
  }
  DrawWays(example, motion, span, view, svg);
  DrawScaleBar(view.pixels_per_m(), box, svg);
}

}  // namespace

std::string LegPictureSvg(const LegExample& example, const LegMotion& motion,
                          absl::string_view title) {
  const double height =
      kTitleHeight + kWayHeight + kGap + kFootHeight + kMargin;
  Svg svg(kWidth, height, title, PictureStyle());
  svg.Rectangle({0, 0, kWidth, height}, 0, "paper");
  svg.Text({kMargin, 40}, title, "title");
  svg.Text(
      {kMargin, 62},
      absl::StrCat("planted points slide at ",
                   Fixed(motion.quality.skate.label_cm_s, 2),
                   " cm/s; the foot sinks by up to ",
                   Fixed(1000 * motion.quality.penetration.max_m, 1), " mm"),
      "");
  const double width = kWidth - 2 * kMargin;
  const Box way = {kMargin, kTitleHeight, width, kWayHeight};
  svg.Text({way.left, way.top - 8}, "the left leg", "heading");
  DrawWholeWay(example, motion, way, svg);
  const Box foot = {kMargin, way.bottom() + kGap, width, kFootHeight};
  svg.Text({foot.left, foot.top - 8}, "its foot as it stands, close up",
           "heading");
  DrawStand(example, motion, foot, svg);
  return std::move(svg).Finish();
}

}  // namespace gelenk::cli
