#include "gelenk/retarget/retarget_clip.h"

#include <utility>

#include "absl/strings/str_format.h"
#include "gelenk/retarget/foot_plan.h"
#include "gelenk/retarget/motion_quality.h"

namespace gelenk {
namespace {

absl::Status CheckClip(const BodyModel& source, const Eigen::MatrixXd& clip,
                       double frame_time_s) {
  if (!(frame_time_s > 0)) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "frame_time_s: want more than 0, got %g", frame_time_s));
  }
  Violations violations;
  Eigen::VectorXd frame;
  for (int f = 0; f < clip.cols(); ++f) {
    frame = clip.col(f);
    if (absl::Status status = CheckPositions(*source.skeleton, frame);
        !status.ok()) {
      violations.AddStatus(absl::StrFormat("frames[%d]", f), status);
    }
  }
  return violations.ToStatus();
}

std::vector<BodyPose> ReadPoses(const std::shared_ptr<const BodyModel>& source,
                                const Eigen::MatrixXd& clip) {
  std::vector<BodyPose> poses(clip.cols());
  BodyPoseReader reader(source);
  for (int f = 0; f < clip.cols(); ++f) reader.Read(clip.col(f), poses[f]);
  return poses;
}

// The feet of every frame: as copied, or planted.
std::vector<Retargeter::CopiedFeet> PlanFeet(absl::Span<const BodyPose> poses,
                                             const ContactLabels& labels,
                                             double frame_time_s,
                                             const RetargetOptions& options,
                                             absl::Span<const double> floors,
                                             Retargeter& retargeter) {
  std::vector<Retargeter::CopiedFeet> feet;
  for (size_t f = 0; f < poses.size(); ++f) {
    feet.push_back(retargeter.CopyFeet(poses[f], floors[f], frame_time_s));
  }
  retargeter.Reset();
  if (!options.plant_feet) return feet;
  const BodyModel& target = retargeter.target();
  for (int side : kSides) {
    std::vector<FootPose> goals;
    std::vector<Eigen::Quaterniond> toes;
    std::vector<std::array<Contact, kFootPointCount>> contacts;
    for (size_t f = 0; f < poses.size(); ++f) {
      goals.push_back(feet[f].feet[side]);
      toes.push_back(feet[f].toes[side]);
      contacts.push_back(labels.frames[f][side]);
    }
    const PlannedFoot plan = PlanFoot(
        {target.feet[side], target.planted_heights[side], retargeter.ground()},
        target.Size(), frame_time_s, goals, toes, contacts);
    for (size_t f = 0; f < poses.size(); ++f) {
      feet[f].feet[side] = plan.feet[f];
      feet[f].toes[side] = plan.toes[f];
    }
  }
  return feet;
}

}  // namespace

absl::StatusOr<RetargetedClip> RetargetClip(
    std::shared_ptr<const BodyModel> source,
    std::shared_ptr<const BodyModel> target,
    const Eigen::MatrixXd& source_positions, double frame_time_s,
    const RetargetOptions& options) {
  if (absl::Status status = CheckClip(*source, source_positions, frame_time_s);
      !status.ok()) {
    return status;
  }
  absl::StatusOr<std::unique_ptr<Retargeter>> retargeter =
      Retargeter::Create(source, target, options);
  if (!retargeter.ok()) return retargeter.status();

  const std::vector<BodyPose> poses = ReadPoses(source, source_positions);
  const bool has_feet =
      source->map.HasLegs() && target->map.HasLegs() && options.place_limbs;
  RetargetedClip clip;
  clip.labels.frames.resize(poses.size());
  if (source->map.HasLegs()) {
    clip.labels =
        LabelContacts(FootPointsOf(poses), frame_time_s, FeetOf(*source),
                      options.source_ground.get(), options.contact_thresholds);
  }
  std::vector<double> floors;
  for (const BodyPose& pose : poses) {
    floors.push_back(options.source_ground != nullptr
                         ? options.source_ground->HeightAt(pose.hip_center)
                         : clip.labels.floor_m);
  }
  std::vector<Retargeter::CopiedFeet> feet;
  if (has_feet) {
    feet = PlanFeet(poses, clip.labels, frame_time_s, options, floors,
                    **retargeter);
  }
  clip.positions.resize(target->skeleton->position_count(),
                        source_positions.cols());
  for (size_t f = 0; f < poses.size(); ++f) {
    if (has_feet) {
      (*retargeter)
          ->RetargetBody(poses[f], clip.labels.frames[f], floors[f], feet[f],
                         frame_time_s);
    } else {
      (*retargeter)
          ->RetargetBody(poses[f], clip.labels.frames[f], floors[f],
                         frame_time_s);
    }
    clip.positions.col(static_cast<Eigen::Index>(f)) =
        (*retargeter)->positions();
    clip.reports.push_back((*retargeter)->report());
  }
  return clip;
}

}  // namespace gelenk
