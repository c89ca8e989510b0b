#include "gelenk/formats/bvh_clip.h"

#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "gelenk/formats/bvh_motion.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/euler.h"
#include "gelenk/motion/clip_frames.h"

namespace gelenk {
namespace {

// ZXY, as most files have it.
constexpr EulerAxes kWrittenAxes = {2, 0, 1};

std::string BvhName(const std::string& id) {
  return absl::StrReplaceAll(id, {{"{", "_"}, {"}", "_"}});
}

// Each joint right before all that is below it.
std::vector<int> DepthFirst(const Skeleton& skeleton) {
  std::vector<std::vector<int>> children(skeleton.joint_count());
  for (int i = 1; i < skeleton.joint_count(); ++i) {
    children[skeleton.span(i).parent].push_back(i);
  }
  std::vector<int> order;
  std::vector<int> waiting = {0};
  while (!waiting.empty()) {
    const int joint = waiting.back();
    waiting.pop_back();
    order.push_back(joint);
    waiting.insert(waiting.end(), children[joint].rbegin(),
                   children[joint].rend());
  }
  return order;
}

BvhJoint JointOf(const MotionClip& clip, int index, double unit_m) {
  const Skeleton& skeleton = *clip.skeleton();
  const Joint& joint = skeleton.joint(index);
  const bool moves = index == 0 || joint.type == JointType::kFree ||
                     joint.type == JointType::kPrismatic ||
                     joint.type == JointType::kPlanar;
  BvhJoint written;
  written.name = BvhName(joint.id);
  written.offset =
      (joint.parent_from_joint *
       JointMotion(skeleton, index, clip.properties().base_positions))
          .translation /
      unit_m;
  if (moves) {
    written.channels = {BvhChannel::kXposition, BvhChannel::kYposition,
                        BvhChannel::kZposition};
  }
  written.channels.insert(
      written.channels.end(),
      {BvhChannel::kZrotation, BvhChannel::kXrotation, BvhChannel::kYrotation});
  return written;
}

}  // namespace

absl::StatusOr<MotionClip> ClipFromBvh(const BvhDocument& document,
                                       const BvhImport& import,
                                       std::string name) {
  const absl::StatusOr<Eigen::MatrixXd> poses = PosesFromBvh(document, import);
  if (!poses.ok()) return poses.status();
  return ClipFromFrames(
      import.skeleton, *poses,
      {.name = std::move(name), .frame_time_s = document.frame_time_s});
}

absl::StatusOr<BvhDocument> BvhFromClip(const BvhDocument& form,
                                        const BvhImport& import,
                                        const MotionClip& clip) {
  const double own_s = clip.properties().frame_time_s;
  const double frame_time_s = own_s > 0 ? own_s : form.frame_time_s;
  const absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(clip, frame_time_s);
  if (!frames.ok()) return frames.status();
  absl::StatusOr<BvhDocument> document = BvhFromPoses(form, import, *frames);
  if (document.ok()) document->frame_time_s = frame_time_s;
  return document;
}

absl::StatusOr<BvhDocument> BvhFromClip(const MotionClip& clip, double unit_m) {
  if (!(std::isfinite(unit_m) && unit_m > 0)) {
    return absl::InvalidArgumentError(
        absl::StrCat("unit_m: want a finite number > 0, got ", unit_m));
  }
  const Skeleton& skeleton = *clip.skeleton();
  const double frame_time_s = FrameTimeOf(clip);
  const absl::StatusOr<Eigen::MatrixXd> frames =
      FramesFromClip(clip, frame_time_s);
  if (!frames.ok()) return frames.status();
  BvhDocument document;
  document.frame_time_s = frame_time_s;
  const std::vector<int> order = DepthFirst(skeleton);
  std::vector<int> place(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = static_cast<int>(i);
    document.joints.push_back(JointOf(clip, order[i], unit_m));
    const int parent = skeleton.span(order[i]).parent;
    document.joints.back().parent = parent < 0 ? -1 : place[parent];
  }
  for (const EndEffector& effector : skeleton.end_effectors()) {
    const int joint = place[skeleton.FindJoint(effector.joint_id)];
    document.joints[joint].end_sites.push_back(
        {BvhName(effector.id),
         effector.joint_from_end_effector.translation / unit_m});
  }
  document.motion.resize(document.channel_count(), frames->cols());
  for (Eigen::Index frame = 0; frame < frames->cols(); ++frame) {
    int row = 0;
    for (size_t i = 0; i < order.size(); ++i) {
      const RigidTransform local =
          skeleton.joint(order[i]).parent_from_joint *
          JointMotion(skeleton, order[i], frames->col(frame));
      auto channels = document.motion.col(frame);
      if (document.joints[i].channels.size() == 6) {
        channels.segment<3>(row) = local.translation / unit_m;
        row += 3;
      }
      Eigen::Vector3d near_rad = Eigen::Vector3d::Zero();
      if (frame > 0) {
        near_rad =
            kRadPerDegree * document.motion.col(frame - 1).segment<3>(row);
      }
      channels.segment<3>(row) =
          EulerFromRotation(kWrittenAxes, local.rotation, near_rad) /
          kRadPerDegree;
      row += 3;
    }
  }
  return document;
}

}  // namespace gelenk
