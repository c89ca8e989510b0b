#include "client/cli/examples/leg_example.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/types/span.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/keyframe_edit.h"
#include "gelenk/retarget/retarget_clip.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk::cli {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kFrameTime_s = 1.0 / 60;
constexpr double kCycle_s = 1.3;
constexpr int kCycles = 3;

// m; Y up, Z forward.
constexpr double kHipHeight = 0.95;
constexpr double kHipSpeed_m_s = 1.0;
constexpr double kHalfPelvis = 0.09;
constexpr double kThigh = 0.45;
constexpr double kShin = 0.43;
constexpr double kAnkleHeight = 0.08;
constexpr double kAnkleToBall = 0.13;
constexpr double kBallHeight = 0.02;
constexpr double kBallToTip = 0.07;

// An angle at a part of the cycle, which begins when the heel strikes; about
// the axis to the left, so that a thigh swings back, a knee bends and a foot
// points down with it.
struct Key {
  double phase;
  double angle_deg;
};
// Rounded, as one types them in. Every track has a key at 0 and at 0.5, so that
// the other leg begins with one, too.
constexpr Key kThighKeys[] = {{0, -22}, {0.25, -2}, {0.5, 18}, {0.75, -14}};
constexpr Key kShinKeys[] = {{0, 5},    {0.15, 10}, {0.4, 8},
                             {0.5, 16}, {0.7, 60},  {0.9, 10}};
constexpr Key kFootKeys[] = {{0, 0},    {0.1, 2},  {0.35, -12},
                             {0.5, -4}, {0.6, 14}, {0.8, -4}};

Joint Ball(std::string id, std::string parent, const Vector3d& place) {
  Joint joint;
  joint.id = std::move(id);
  joint.parent_id = std::move(parent);
  joint.type = JointType::kSpherical;
  joint.parent_from_joint.translation = place;
  return joint;
}

absl::StatusOr<std::shared_ptr<const Skeleton>> MakeLegs() {
  SkeletonBuilder builder;
  Joint hip;
  hip.id = "hip";
  hip.type = JointType::kFree;
  builder.AddJoint(hip);
  for (const std::string side : {"left", "right"}) {
    const double x = side == "left" ? kHalfPelvis : -kHalfPelvis;
    const std::string thigh = side + "_thigh";
    const std::string shin = side + "_shin";
    const std::string foot = side + "_foot";
    const std::string toe = side + "_toe";
    builder.AddJoint(Ball(thigh, "hip", {x, 0, 0}))
        .AddJoint(Ball(shin, thigh, {0, -kThigh, 0}))
        .AddJoint(Ball(foot, shin, {0, -kShin, 0}))
        .AddJoint(
            Ball(toe, foot, {0, kBallHeight - kAnkleHeight, kAnkleToBall}));
    EndEffector tip;
    tip.id = toe + "_tip";
    tip.joint_id = toe;
    tip.joint_from_end_effector.translation = {0, -kBallHeight, kBallToTip};
    builder.AddEndEffector(tip);
  }
  return builder.Build();
}

// Keys of one joint of one leg over all cycles.
absl::StatusOr<MotionClip> WithKeys(MotionClip clip, const std::string& joint,
                                    double delay, absl::Span<const Key> keys) {
  const int index = clip.skeleton()->FindJoint(joint);
  for (int cycle = -1; cycle <= kCycles; ++cycle) {
    for (const Key& key : keys) {
      const double time_s = (cycle + key.phase + delay) * kCycle_s;
      if (time_s < 0 || time_s > kCycles * kCycle_s + kSameKey_s) continue;
      const Eigen::Quaterniond turn =
          ExpRotation({key.angle_deg * kDegree, 0, 0});
      absl::StatusOr<MotionClip> next =
          InsertKey(clip, index, PosePartKind::kRotation, time_s,
                    absl::MakeSpan(turn.coeffs().data(), 4));
      if (!next.ok()) return next.status();
      clip = *std::move(next);
    }
  }
  return clip;
}

// Top-down: the hip's way first, then thighs, shins and feet.
absl::StatusOr<MotionClip> KeyedClip(
    const std::shared_ptr<const Skeleton>& skeleton) {
  absl::StatusOr<MotionClip> clip = MotionClip::Create(
      skeleton, {}, {.name = "leg", .frame_time_s = kFrameTime_s});
  for (const double time_s : {0.0, kCycles * kCycle_s}) {
    if (!clip.ok()) return clip;
    const Vector3d place(0, kHipHeight, kHipSpeed_m_s * time_s);
    clip = InsertKey(*clip, skeleton->FindJoint("hip"), PosePartKind::kNumbers,
                     time_s, absl::MakeSpan(place.data(), 3),
                     ChildrenOnEdit::kFollow, Interpolation::kLinear);
  }
  const std::pair<const char*, absl::Span<const Key>> tracks[] = {
      {"_thigh", kThighKeys}, {"_shin", kShinKeys}, {"_foot", kFootKeys}};
  for (const auto& [part, keys] : tracks) {
    for (const auto& [side, delay] :
         {std::pair("left", 0.0), std::pair("right", 0.5)}) {
      if (!clip.ok()) return clip;
      clip = WithKeys(*std::move(clip), absl::StrCat(side, part), delay, keys);
    }
  }
  return clip;
}

LegMotion Measured(const std::shared_ptr<const BodyModel>& model,
                   const Eigen::MatrixXd& positions,
                   const ContactLabels& labels) {
  LegMotion motion;
  motion.poses.resize(positions.cols());
  BodyPoseReader reader(model);
  for (int f = 0; f < positions.cols(); ++f) {
    reader.Read(positions.col(f), motion.poses[f]);
  }
  const FlatGround ground;
  motion.quality =
      MeasureMotion({*model, motion.poses, kFrameTime_s}, labels, &ground);
  return motion;
}

}  // namespace

absl::StatusOr<LegExample> MakeLegExample() {
  const auto skeleton = MakeLegs();
  if (!skeleton.ok()) return skeleton.status();
  const auto map = ProposeJointMap(**skeleton);
  if (!map.ok()) return map.status();
  const auto model = MakeBodyModel(*skeleton, *map);
  if (!model.ok()) return model.status();
  const auto clip = KeyedClip(*skeleton);
  if (!clip.ok()) return clip.status();
  const auto frames = FramesFromClip(*clip);
  if (!frames.ok()) return frames.status();

  // The body is its own source: what changes is what its contacts ask for.
  RetargetOptions options;
  options.source_ground = std::make_shared<const FlatGround>();
  const auto planted =
      RetargetClip(*model, *model, *frames, kFrameTime_s, options);
  if (!planted.ok()) return planted.status();
  LegExample example;
  example.model = *model;
  example.frame_time_s = kFrameTime_s;
  example.labels = planted->labels;
  example.keyed = Measured(*model, *frames, example.labels);
  example.planted = Measured(*model, planted->positions, example.labels);
  return example;
}

}  // namespace gelenk::cli
