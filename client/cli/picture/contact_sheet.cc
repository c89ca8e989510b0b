#include "client/cli/picture/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "client/cli/picture/camera.h"
#include "client/cli/picture/stick_figure.h"
#include "client/cli/picture/style.h"
#include "client/cli/picture/svg.h"
#include "client/cli/picture/time_chart.h"
#include "gelenk/kinematics/forward_kinematics.h"

namespace gelenk::cli {
namespace {

using Eigen::Vector3d;

constexpr double kWidth = 1200;
constexpr double kMargin = 32;
constexpr double kTitleHeight = 84;
constexpr double kFigureHeight = 190;
constexpr double kFigurePadding = 14;
constexpr double kHeadingHeight = 30;
constexpr double kStripHeight = 10;
constexpr double kChartHeight = 84;
constexpr double kAxisHeight = 34;
constexpr double kPointRadius = 2.6;
// From the front towards the left side of the body; level, so that all feet
// stand on one line.
constexpr double kAzimuthRad = 55 * std::numbers::pi / 180;
// Shorter bones are not to be seen, pixels.
constexpr double kShortestBone = 1.5;
constexpr double kSmallestBody_m = 1e-3;
// Slower than this is standing, cm/s.
constexpr double kStandingSpeed = 1;
constexpr double kCmPerM = 100;

// Where things are on the sheet; time goes from left to right.
struct Columns {
  double left = kMargin + kChartLabelWidth;
  double width = kWidth - 2 * kMargin - kChartLabelWidth;
};

BodyParts PartsOf(const JointMap& map) {
  BodyParts parts;
  parts.hips = map.joint(BodyRole::kPelvis);
  parts.left_hand = map.joint(BodyRole::kLeftHand);
  parts.right_hand = map.joint(BodyRole::kRightHand);
  parts.left_foot = map.joint(BodyRole::kLeftFoot);
  parts.right_foot = map.joint(BodyRole::kRightFoot);
  parts.head = map.joint(BodyRole::kHead);
  return parts;
}

// Evenly spread over the clip.
std::vector<int> ChosenFrames(int frame_count) {
  const int count = std::min(kMostSheetFigures, frame_count);
  std::vector<int> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(static_cast<int>((i + 0.5) / count * frame_count));
  }
  return frames;
}

Camera CameraOf(const SheetMotion& motion) {
  const BodyPose& middle = motion.poses[motion.poses.size() / 2];
  Vector3d facing =
      Horizontal(middle.rotation(BodyRole::kPelvis) * Vector3d::UnitZ());
  if (facing.norm() < 1e-6) facing = Vector3d::UnitZ();
  return Camera(
      Vector3d::UnitY(),
      Eigen::AngleAxisd(kAzimuthRad, Vector3d::UnitY()) * facing.normalized());
}

class FigureRow {
 public:
  FigureRow(const SheetMotion& motion, const ContactLabels& labels,
            const Box& box)
      : motion_(motion),
        labels_(labels),
        box_(box),
        camera_(CameraOf(motion)),
        halves_(HalvesOf(*motion.model.skeleton, PartsOf(motion.model.map))) {
    double height = kSmallestBody_m;
    for (int frame : ChosenFrames(static_cast<int>(motion.poses.size()))) {
      for (const Bone& bone : BonesAt(frame)) {
        height = std::max({height, bone.world_from.y(), bone.world_to.y()});
      }
    }
    pixels_per_m_ = (box.height - 2 * kFigurePadding) / height;
  }

  void Draw(Svg& svg) {
    svg.Rectangle(box_, 6, "panel");
    const double ground = box_.bottom() - kFigurePadding;
    svg.Line({box_.left, ground}, {box_.right(), ground}, "ground");
    const int count = static_cast<int>(motion_.poses.size());
    for (int frame : ChosenFrames(count)) {
      DrawFigure(frame,
                 {box_.left + box_.width * (frame + 0.5) / count, ground}, svg);
    }
  }

 private:
  // Bones in canonical coordinates, as from the place on the floor below the
  // hips.
  std::vector<Bone> BonesAt(int frame) {
    ForwardKinematics(*motion_.model.skeleton, motion_.positions.col(frame),
                      frames_);
    std::vector<Bone> bones =
        BonesOf(*motion_.model.skeleton, halves_, frames_);
    for (Bone& bone : bones) {
      bone.world_from =
          FromHips(frame, motion_.model.canonical_from_world * bone.world_from);
      bone.world_to =
          FromHips(frame, motion_.model.canonical_from_world * bone.world_to);
    }
    return bones;
  }

  Vector3d FromHips(int frame, const Vector3d& canonical) const {
    Vector3d origin = motion_.poses[frame].hip_center;
    origin.y() = motion_.floor_m;
    return canonical - origin;
  }

  void DrawFigure(int frame, const Point& origin, Svg& svg) {
    const auto at = [&](const Vector3d& from_hips) -> Point {
      return origin + pixels_per_m_ * camera_.Project(from_hips);
    };
    svg.OpenGroup("figure");
    for (const Bone& bone : BonesAt(frame)) {
      const Point from = at(bone.world_from);
      const Point to = at(bone.world_to);
      if ((to - from).norm() < kShortestBone) continue;
      svg.Line(from, to, BoneClass(bone.half));
    }
    svg.CloseGroup();
    for (int side : kSides) {
      // Many rigs end at the ankle: the sole is what stands.
      const auto& foot = motion_.poses[frame].foot_points[side];
      const Point sole[] = {
          at(FromHips(frame,
                      motion_.poses[frame].position(kLegRoles[side].foot))),
          at(FromHips(frame, foot[kHeel])), at(FromHips(frame, foot[kBall]))};
      svg.Polyline(sole, side == kLeft ? "thin left" : "thin right");
      for (const int point : {kHeel, kBall}) {
        const Contact contact = labels_.frames[frame][side][point];
        if (contact == Contact::kNone) continue;
        svg.Circle(
            at(FromHips(frame, motion_.poses[frame].foot_points[side][point])),
            kPointRadius, contact == Contact::kPlanted ? "contact" : "turning");
      }
    }
  }

  const SheetMotion& motion_;
  const ContactLabels& labels_;
  const Box box_;
  const Camera camera_;
  const std::vector<BodyHalf> halves_;
  double pixels_per_m_ = 1;
  WorldTransforms frames_;
};

bool Stands(const ContactLabels& labels, int frame, int side) {
  const auto& foot = labels.frames[frame][side];
  return foot[kHeel] != Contact::kNone || foot[kBall] != Contact::kNone;
}

// When each foot stands.
void DrawContacts(const ContactLabels& labels, const Box& box, Svg& svg) {
  const int count = static_cast<int>(labels.frames.size());
  for (int side : kSides) {
    const double top = box.top + side * (kStripHeight + 3);
    svg.Text({box.left - 8, top + kStripHeight - 1},
             side == kLeft ? "left foot" : "right foot", "end");
    svg.Rectangle({box.left, top, box.width, kStripHeight}, 0, "panel");
    for (int begin = 0; begin < count; ++begin) {
      int end = begin;
      while (end < count && Stands(labels, end, side)) ++end;
      if (end == begin) continue;
      svg.Rectangle({box.left + box.width * begin / count, top,
                     box.width * (end - begin) / count, kStripHeight},
                    0, side == kLeft ? "left-fill" : "right-fill");
      begin = end;
    }
  }
}

// Of the planted heels and balls at each frame, the fastest, cm/s; 0 where
// none is planted.
std::vector<double> SlidingSpeeds(const SheetMotion& motion,
                                  const ContactLabels& labels,
                                  double frame_time_s) {
  std::vector<double> speeds(motion.poses.size(), 0);
  for (size_t f = 1; f < motion.poses.size(); ++f) {
    for (int side : kSides) {
      for (const int point : {kHeel, kBall}) {
        if (labels.frames[f][side][point] != Contact::kPlanted ||
            labels.frames[f - 1][side][point] != Contact::kPlanted) {
          continue;
        }
        const Vector3d way =
            Horizontal(motion.poses[f].foot_points[side][point] -
                       motion.poses[f - 1].foot_points[side][point]);
        speeds[f] = std::max(speeds[f], kCmPerM * way.norm() / frame_time_s);
      }
    }
  }
  return speeds;
}

}  // namespace

std::string ContactSheetSvg(absl::string_view title,
                            absl::Span<const SheetMotion> motions,
                            const ContactLabels& labels, double frame_time_s) {
  const Columns columns;
  const double strips = 2 * kStripHeight + 3;
  const double row =
      kHeadingHeight + kFigureHeight + kHeadingHeight + kChartHeight;
  const double height =
      kTitleHeight + motions.size() * row + 20 + strips + kAxisHeight + kMargin;
  Svg svg(kWidth, height, title, PictureStyle());
  svg.Rectangle({0, 0, kWidth, height}, 0, "paper");
  svg.Text({kMargin, 40}, title, "title");
  svg.Text({kMargin, 62},
           "dots: heels and balls that stand; rings: that the foot turns about",
           "");
  double top = kTitleHeight;
  for (const SheetMotion& motion : motions) {
    const Box figures = {columns.left, top + kHeadingHeight, columns.width,
                         kFigureHeight};
    svg.Text({columns.left, figures.top - 8}, motion.name, "heading");
    FigureRow(motion, labels, figures).Draw(svg);
    DrawTimeChart({.heading = "fastest planted point",
                   .unit = "cm/s",
                   .values = SlidingSpeeds(motion, labels, frame_time_s),
                   .tolerance = kStandingSpeed},
                  {columns.left, figures.bottom() + kHeadingHeight,
                   columns.width, kChartHeight},
                  svg);
    top += row;
  }
  const Box contacts = {columns.left, top + 20, columns.width, strips};
  DrawContacts(labels, contacts, svg);
  DrawTimeAxis(frame_time_s * static_cast<double>(labels.frames.size()),
               contacts, svg);
  return std::move(svg).Finish();
}

}  // namespace gelenk::cli
