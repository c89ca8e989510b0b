#include "gelenk/formats/bvh_motion.h"

#include "absl/strings/str_format.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {
namespace {

absl::Status CheckChannels(const BvhDocument& document,
                           const BvhImport& import) {
  const int want = import.mapping.channel_count;
  if (document.channel_count() == want && document.motion.rows() == want) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat(
      "motion: want %d channels as imported, got %d joints' channels and %d "
      "rows",
      want, document.channel_count(), document.motion.rows()));
}

absl::Status CheckPoses(const Skeleton& skeleton,
                        const Eigen::MatrixXd& poses) {
  if (poses.rows() != skeleton.position_count()) {
    return absl::InvalidArgumentError(
        absl::StrFormat("poses: want %d rows, got %d",
                        skeleton.position_count(), poses.rows()));
  }
  for (int frame = 0; frame < poses.cols(); ++frame) {
    if (poses.col(frame).allFinite()) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "poses: frame %d has a number that is not finite", frame));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Eigen::MatrixXd> PosesFromBvh(const BvhDocument& document,
                                             const BvhImport& import) {
  if (absl::Status status = CheckChannels(document, import); !status.ok()) {
    return status;
  }
  const Skeleton& skeleton = *import.skeleton;
  Eigen::MatrixXd poses(skeleton.position_count(), document.frame_count());
  for (int frame = 0; frame < document.frame_count(); ++frame) {
    PoseFromChannels(import.mapping, document.motion.col(frame),
                     poses.col(frame));
    if (frame > 0) {
      AlignHemispheres(skeleton, poses.col(frame - 1), poses.col(frame));
    }
  }
  return poses;
}

absl::StatusOr<BvhDocument> BvhFromPoses(const BvhDocument& form,
                                         const BvhImport& import,
                                         const Eigen::MatrixXd& poses) {
  if (absl::Status status = CheckChannels(form, import); !status.ok()) {
    return status;
  }
  if (absl::Status status = CheckPoses(*import.skeleton, poses); !status.ok()) {
    return status;
  }
  BvhDocument document;
  document.joints = form.joints;
  document.frame_time_s = form.frame_time_s;
  document.frame_time_text = form.frame_time_text;
  document.motion.resize(form.motion.rows(), poses.cols());
  Eigen::VectorXd channels = Eigen::VectorXd::Zero(form.motion.rows());
  if (form.frame_count() > 0) channels = form.motion.col(0);
  for (int frame = 0; frame < poses.cols(); ++frame) {
    ChannelsFromPose(import.mapping, poses.col(frame), channels, channels);
    document.motion.col(frame) = channels;
  }
  return document;
}

}  // namespace gelenk
