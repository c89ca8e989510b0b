#include "gelenk/motion/gait_phase.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/motion/blender.h"
#include "gelenk/motion/body_parts.h"
#include "gelenk/motion/body_shape.h"
#include "gelenk/motion/clip_frames.h"
#include "gelenk/motion/low_pass.h"
#include "gelenk/motion/sampler.h"
#include "gelenk/skeleton/skeleton_builder.h"

namespace gelenk {
namespace {

// Who gets this far goes somewhere; less says nothing about the heading, m.
constexpr double kTravel_m = 0.3;

// Joints of the two legs that are as close at rest are in one place, m.
constexpr double kSamePlace_m = 1e-6;

struct Legs {
  int left_foot, right_foot;
  // The topmost joints of each leg alone that are apart.
  int left_hip, right_hip;
};

// From below `ancestor` down to `joint`.
std::vector<int> ChainBelow(const Skeleton& skeleton, int joint, int ancestor) {
  std::vector<int> chain;
  for (; joint >= 0 && joint != ancestor; joint = skeleton.span(joint).parent) {
    chain.push_back(joint);
  }
  std::reverse(chain.begin(), chain.end());
  return chain;
}

absl::StatusOr<Legs> FindLegs(const Skeleton& skeleton) {
  const BodyParts body = FindBodyParts(skeleton);
  if (body.left_foot < 0 || body.right_foot < 0) {
    return absl::FailedPreconditionError(
        "skeleton: no left and right foot were found");
  }
  const int pelvis = CommonAncestor(skeleton, body.left_foot, body.right_foot);
  // Some rigs begin both legs with a joint in the place of the pelvis.
  const std::vector<int> left = ChainBelow(skeleton, body.left_foot, pelvis);
  const std::vector<int> right = ChainBelow(skeleton, body.right_foot, pelvis);
  if (left.empty() || right.empty()) {
    return absl::FailedPreconditionError(
        "skeleton: one foot hangs from the other: these are no two legs");
  }
  WorldTransforms frames;
  ForwardKinematics(skeleton, skeleton.rest_positions(), frames);
  const size_t last = std::min(left.size(), right.size()) - 1;
  size_t hip = 0;
  while (
      hip < last &&
      (frames[left[hip]].translation - frames[right[hip]].translation).norm() <=
          kSamePlace_m) {
    ++hip;
  }
  return Legs{body.left_foot, body.right_foot, left[hip], right[hip]};
}

Eigen::Vector3d OnGround(const Skeleton& skeleton, const Eigen::Vector3d& v) {
  return v - v.dot(skeleton.up()) * skeleton.up();
}

// Unit, on the ground; zero where the hips are above each other.
Eigen::Vector3d Facing(const Skeleton& skeleton, const Legs& legs,
                       const WorldTransforms& frames) {
  const Eigen::Vector3d across =
      OnGround(skeleton, frames[legs.left_hip].translation -
                             frames[legs.right_hip].translation);
  return across.cross(skeleton.up()).normalized();
}

// Without tremor; as it is where frames are too few a second for that.
Eigen::VectorXd Smooth(const Eigen::VectorXd& signal, double frame_time_s) {
  Joint slider;
  slider.id = "signal";
  slider.type = JointType::kPrismatic;
  const auto skeleton = SkeletonBuilder().AddJoint(slider).Build();
  const auto smooth =
      LowPass(**skeleton, signal.transpose(), frame_time_s, kMaxStepRate_hz);
  return smooth.ok() ? Eigen::VectorXd(smooth->row(0)) : signal;
}

// The place of the extreme around frame `i`, by a parabola, in frames.
double Refined(const Eigen::VectorXd& signal, Eigen::Index i) {
  if (i == 0 || i + 1 == signal.size()) return static_cast<double>(i);
  const double bend = signal[i - 1] - 2 * signal[i] + signal[i + 1];
  if (bend == 0) return static_cast<double>(i);
  return static_cast<double>(i) +
         std::clamp(0.5 * (signal[i - 1] - signal[i + 1]) / bend, -0.5, 0.5);
}

// Maxima and minima in turn, each confirmed once the signal has come back from
// it by `threshold`; none at the ends.
GaitPhase FindExtremes(const Eigen::VectorXd& signal, double threshold,
                       double frame_time_s) {
  GaitPhase phase;
  Eigen::Index highest = 0, lowest = 0;
  // 1 on the look-out for a maximum, -1 for a minimum, 0 for either.
  int wanted = 0;
  const auto take = [&](Eigen::Index i, bool is_left) {
    if (i > 0) {
      if (phase.strikes_s.empty()) phase.first_is_left = is_left;
      phase.strikes_s.push_back(Refined(signal, i) * frame_time_s);
      phase.strides_m.push_back(std::abs(signal[i]));
    }
    highest = lowest = i;
  };
  for (Eigen::Index i = 0; i < signal.size(); ++i) {
    if (signal[i] > signal[highest]) highest = i;
    if (signal[i] < signal[lowest]) lowest = i;
    if (wanted >= 0 && signal[i] < signal[highest] - threshold) {
      take(highest, true);
      wanted = -1;
      lowest = i;
    } else if (wanted <= 0 && signal[i] > signal[lowest] + threshold) {
      take(lowest, false);
      wanted = 1;
      highest = i;
    }
  }
  return phase;
}

// The first strikes that are of the same foot.
std::pair<size_t, size_t> FirstInCommon(const GaitPhase& a,
                                        const GaitPhase& b) {
  return {0, a.first_is_left == b.first_is_left ? 0 : 1};
}

size_t StrikesInCommon(const GaitPhase& a, const GaitPhase& b) {
  const auto [first_a, first_b] = FirstInCommon(a, b);
  return std::min(a.strikes_s.size() - first_a,
                  b.strikes_s.size() - std::min(first_b, b.strikes_s.size()));
}

// Where the root is on the ground and which way it goes, between two times.
struct Course {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  Eigen::Vector3d heading = Eigen::Vector3d::Zero();
};

Course CourseOf(const MotionClip& clip, const Legs& legs, double start_s,
                double end_s) {
  const Skeleton& skeleton = *clip.skeleton();
  Sampler sampler(clip);
  Eigen::VectorXd pose = skeleton.rest_positions();
  WorldTransforms frames;
  sampler.Sample(end_s, pose);
  ForwardKinematics(skeleton, pose, frames);
  const Eigen::Vector3d end = OnGround(skeleton, frames[0].translation);
  sampler.Sample(start_s, pose);
  ForwardKinematics(skeleton, pose, frames);
  Course course;
  course.start = OnGround(skeleton, frames[0].translation);
  const Eigen::Vector3d way = end - course.start;
  course.heading = way.norm() > kTravel_m ? way.normalized()
                                          : Facing(skeleton, legs, frames);
  return course;
}

// On the ground from one course to another.
RigidTransform Onto(const Skeleton& skeleton, const Course& from,
                    const Course& to) {
  const Eigen::Vector3d& up = skeleton.up();
  const double angle_rad = std::atan2(from.heading.cross(to.heading).dot(up),
                                      from.heading.dot(to.heading));
  RigidTransform move;
  move.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, up));
  move.translation = to.start - move.rotation * from.start;
  return move;
}

void MoveRoot(const Skeleton& skeleton, const RigidTransform& move,
              Eigen::VectorXd& positions) {
  if (skeleton.joint(0).type != JointType::kFree) return;
  const RigidTransform& rest = skeleton.joint(0).parent_from_joint;
  const RigidTransform local =
      rest.Inverse() * move * rest * JointMotion(skeleton, 0, positions);
  const int at = skeleton.span(0).position_offset;
  positions.segment<3>(at) = local.translation;
  StoreXyzw(local.rotation.normalized(), positions.data() + at + 3);
}

}  // namespace

absl::StatusOr<GaitPhase> FindGaitPhase(const MotionClip& clip) {
  const Skeleton& skeleton = *clip.skeleton();
  const absl::StatusOr<Legs> legs = FindLegs(skeleton);
  if (!legs.ok()) return legs.status();
  const double frame_time_s = FrameTimeOf(clip);
  const absl::StatusOr<Eigen::MatrixXd> poses =
      FramesFromClip(clip, frame_time_s);
  if (!poses.ok()) return poses.status();
  Eigen::VectorXd ahead_m(poses->cols());
  WorldTransforms frames;
  for (Eigen::Index i = 0; i < poses->cols(); ++i) {
    ForwardKinematics(skeleton, poses->col(i), frames);
    ahead_m[i] = Facing(skeleton, *legs, frames)
                     .dot(frames[legs->left_foot].translation -
                          frames[legs->right_foot].translation);
  }
  ahead_m = Smooth(ahead_m, frame_time_s);
  const double range_m = ahead_m.maxCoeff() - ahead_m.minCoeff();
  GaitPhase phase = FindExtremes(ahead_m, kMinStride * range_m, frame_time_s);
  if (phase.strikes_s.size() < 2) {
    return absl::FailedPreconditionError(
        absl::StrFormat("clip: want at least two strikes of feet, found %d",
                        phase.strikes_s.size()));
  }
  return phase;
}

std::vector<WarpKey> AlignStrikes(const GaitPhase& reference,
                                  const GaitPhase& phase) {
  const auto [first, own_first] = FirstInCommon(reference, phase);
  const size_t count = StrikesInCommon(reference, phase);
  std::vector<WarpKey> keys;
  if (count < 2) return keys;
  for (size_t i = 0; i < count; ++i) {
    keys.push_back({reference.strikes_s[first + i] - reference.strikes_s[first],
                    phase.strikes_s[own_first + i]});
  }
  return keys;
}

absl::StatusOr<MotionClip> BlendGaits(const MotionClip& first,
                                      const MotionClip& second, double part) {
  if (first.skeleton() != second.skeleton()) {
    return absl::InvalidArgumentError("second: is of another skeleton");
  }
  if (!(part >= 0 && part <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat("part: want 0 to 1, got ", part));
  }
  const Skeleton& skeleton = *first.skeleton();
  const absl::StatusOr<Legs> legs = FindLegs(skeleton);
  if (!legs.ok()) return legs.status();
  const absl::StatusOr<GaitPhase> a = FindGaitPhase(first);
  if (!a.ok()) return a.status();
  const absl::StatusOr<GaitPhase> b = FindGaitPhase(second);
  if (!b.ok()) return b.status();
  const size_t count = StrikesInCommon(*a, *b);
  if (count < 2) {
    return absl::FailedPreconditionError(
        "clips: fewer than two strikes of the same feet in common");
  }
  const auto [first_a, first_b] = FirstInCommon(*a, *b);
  const double* strikes_a = a->strikes_s.data() + first_a;
  const double* strikes_b = b->strikes_s.data() + first_b;
  std::vector<double> strikes_s = {0};
  for (size_t i = 1; i < count; ++i) {
    strikes_s.push_back(strikes_s.back() +
                        (1 - part) * (strikes_a[i] - strikes_a[i - 1]) +
                        part * (strikes_b[i] - strikes_b[i - 1]));
  }
  const RigidTransform onto = Onto(
      skeleton, CourseOf(second, *legs, strikes_b[0], strikes_b[count - 1]),
      CourseOf(first, *legs, strikes_a[0], strikes_a[count - 1]));
  const double frame_time_s = FrameTimeOf(first);
  const int steps =
      static_cast<int>(std::floor(strikes_s.back() / frame_time_s + 1e-3));
  Eigen::MatrixXd frames(skeleton.position_count(), steps + 1);
  Sampler sampler_a(first), sampler_b(second);
  Eigen::VectorXd pose_a = skeleton.rest_positions(), pose_b = pose_a;
  const Blender blender(first.skeleton());
  size_t next = 1;
  for (int i = 0; i <= steps; ++i) {
    const double time_s = i * frame_time_s;
    while (next + 1 < count && strikes_s[next] <= time_s) ++next;
    const double u = (time_s - strikes_s[next - 1]) /
                     (strikes_s[next] - strikes_s[next - 1]);
    sampler_a.Sample(std::lerp(strikes_a[next - 1], strikes_a[next], u),
                     pose_a);
    sampler_b.Sample(std::lerp(strikes_b[next - 1], strikes_b[next], u),
                     pose_b);
    MoveRoot(skeleton, onto, pose_b);
    frames.col(i) = pose_a;
    const BlendInput inputs[] = {
        {.positions = pose_a.data(), .weight = 1 - part},
        {.positions = pose_b.data(), .weight = part}};
    blender.Blend(inputs, frames.col(i));
  }
  return ClipFromFrames(first.skeleton(), frames,
                        {.name = first.name(), .frame_time_s = frame_time_s});
}

}  // namespace gelenk
