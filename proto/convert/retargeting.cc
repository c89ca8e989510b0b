#include "convert/retargeting.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "convert/duration.h"
#include "convert/geometry.h"
#include "convert/joint_map.h"
#include "convert/pose.h"
#include "gelenk/base/violations.h"
#include "gelenk/contact/ground.h"
#include "gelenk/retarget/tracker_goals.h"
#include "gelenk/skeleton/joint_check.h"

namespace gelenk::convert {
namespace {

// Of one body, whose field in the message is `field`.
struct Calibration {
  // Empty where none is given.
  Eigen::VectorXd reference;
  Eigen::MatrixXd positions;
  double frame_time_s = 1.0 / 30;
  int first_frame = 0;

  std::optional<ClipView> clip() const {
    if (positions.cols() == 0) return std::nullopt;
    return ClipView{positions, frame_time_s, first_frame};
  }
};

// Frames of `proto`, columns in `calibration`.
void ReadMotion(const v1::BodyCalibration& proto, const Skeleton& skeleton,
                Calibration& calibration, Violations& violations) {
  const int size = proto.positions_size();
  const int rows = skeleton.position_count();
  if (size == 0) return;
  if (size > kMaxCalibrationNumbers) {
    violations.Add("positions",
                   absl::StrFormat("want at most %d numbers, got %d",
                                   kMaxCalibrationNumbers, size));
    return;
  }
  if (rows == 0 || size % rows != 0) {
    violations.Add("positions", absl::StrFormat("want a multiple of %d "
                                                "numbers, got %d",
                                                rows, size));
    return;
  }
  calibration.positions = Eigen::Map<const Eigen::MatrixXd>(
      proto.positions().data(), rows, size / rows);
  for (int f = 0; f < calibration.positions.cols(); ++f) {
    violations.AddStatus(
        absl::StrCat("frames[", f, "]"),
        CheckPositions(skeleton, calibration.positions.col(f)));
  }
  calibration.first_frame = proto.first_frame();
  if (proto.first_frame() < 0 ||
      proto.first_frame() >= calibration.positions.cols()) {
    violations.Add(
        "first_frame",
        absl::StrFormat("want 0 to %d, got %d",
                        calibration.positions.cols() - 1, proto.first_frame()));
  }
  if (!proto.has_frame_time_s()) return;
  calibration.frame_time_s = proto.frame_time_s();
  if (!(proto.frame_time_s() > 0) ||
      proto.frame_time_s() > Retargeter::kMaxFrameTime_s) {
    violations.Add(
        "frame_time_s",
        absl::StrFormat("want more than 0 and at most %g, got %g",
                        Retargeter::kMaxFrameTime_s, proto.frame_time_s()));
  }
}

absl::StatusOr<Calibration> ReadCalibration(const v1::BodyCalibration& proto,
                                            const Skeleton& skeleton) {
  Calibration calibration;
  Violations violations;
  if (proto.has_reference_pose()) {
    absl::StatusOr<Eigen::VectorXd> pose =
        FromProto(skeleton, proto.reference_pose());
    if (pose.ok()) {
      calibration.reference = *std::move(pose);
    } else {
      violations.AddStatus("reference_pose", pose.status());
    }
  }
  ReadMotion(proto, skeleton, calibration, violations);
  if (!violations.empty()) return violations.ToStatus();
  return calibration;
}

// Model of one side of the map.
std::shared_ptr<const BodyModel> ReadModel(
    const v1::JointMap& map, MapSide side,
    const std::shared_ptr<const Skeleton>& skeleton,
    const v1::BodyCalibration& calibration_proto, absl::string_view field,
    Violations& violations) {
  const auto overrides = FromProto(map, side, *skeleton);
  violations.AddStatus("joint_map", overrides.status());
  const auto calibration = ReadCalibration(calibration_proto, *skeleton);
  violations.AddStatus(field, calibration.status());
  if (!overrides.ok() || !calibration.ok()) return nullptr;
  const std::optional<ClipView> view = calibration->clip();
  const ClipView* clip = view ? &*view : nullptr;
  const auto roles = ProposeJointMap(*skeleton, *overrides, clip);
  violations.AddStatus("joint_map", roles.status());
  if (!roles.ok()) return nullptr;
  BodyModelOptions options;
  if (calibration->reference.size() > 0) {
    options.reference_positions = calibration->reference;
  }
  const auto model = MakeBodyModel(skeleton, *roles, clip, options);
  violations.AddStatus(field, model.status());
  return model.ok() ? *model : nullptr;
}

TrackedPerson ReadTrackers(const v1::Trackers& proto, const BodyModel& target,
                           Violations& violations) {
  TrackedPerson person;
  if (proto.has_height_m()) person.height_m = proto.height_m();
  if (proto.t_pose_size() == 0) return person;
  TrackerFrame& t_pose = person.t_pose.emplace();
  const RigidTransform canonical_from_world = {target.canonical_from_world,
                                               Eigen::Vector3d::Zero()};
  for (int i = 0; i < proto.t_pose_size(); ++i) {
    const std::string field = absl::StrCat("trackers.t_pose[", i, "]");
    const v1::TrackerPlace& place = proto.t_pose(i);
    std::optional<RigidTransform>* tracker =
        FindTracker(place.goal_id(), t_pose);
    if (tracker == nullptr) {
      violations.Add(
          absl::StrCat(field, ".goal_id"),
          absl::StrCat("no tracker is called \"", place.goal_id(), "\""));
      continue;
    }
    RigidTransform pose = FromProto(place.world_pose());
    CheckAndNormalize(absl::StrCat(field, ".world_pose"), pose, violations);
    *tracker = canonical_from_world * pose;
  }
  return person;
}

std::shared_ptr<const Ground> ReadGround(absl::string_view field, bool is_given,
                                         double height_m,
                                         Violations& violations) {
  if (!is_given) return nullptr;
  if (!std::isfinite(height_m)) {
    violations.Add(field,
                   absl::StrFormat("want a finite number, got %g", height_m));
  }
  return std::make_shared<FlatGround>(height_m);
}

void ReadThreshold(absl::string_view field, bool is_given, double value,
                   double& threshold, Violations& violations) {
  if (!is_given) return;
  threshold = value;
  if (std::isfinite(value) && value > 0) return;
  violations.Add(absl::StrCat("contact_thresholds.", field),
                 absl::StrFormat("want more than 0, got %g", value));
}

ContactThresholds ReadThresholds(const v1::ContactThresholds& proto,
                                 Violations& violations) {
  ContactThresholds read;
  ReadThreshold("max_height_on_m", proto.has_max_height_on_m(),
                proto.max_height_on_m(), read.max_height_on, violations);
  ReadThreshold("max_height_off_m", proto.has_max_height_off_m(),
                proto.max_height_off_m(), read.max_height_off, violations);
  ReadThreshold("max_speed_on_m_per_s", proto.has_max_speed_on_m_per_s(),
                proto.max_speed_on_m_per_s(), read.max_speed_on, violations);
  ReadThreshold("max_speed_off_m_per_s", proto.has_max_speed_off_m_per_s(),
                proto.max_speed_off_m_per_s(), read.max_speed_off, violations);
  const auto check = [&](absl::string_view what, double on, double off) {
    if (!(on > off)) return;
    violations.Add(
        "contact_thresholds",
        absl::StrFormat("%s: on at %g, above off at %g", what, on, off));
  };
  check("max_height", read.max_height_on, read.max_height_off);
  check("max_speed", read.max_speed_on, read.max_speed_off);
  return read;
}

RetargetOptions ReadOptions(const v1::Retargeting& proto, InstructionSet level,
                            Violations& violations) {
  RetargetOptions options;
  options.source_ground =
      ReadGround("source_ground_m", proto.has_source_ground_m(),
                 proto.source_ground_m(), violations);
  options.target_ground =
      ReadGround("target_ground_m", proto.has_target_ground_m(),
                 proto.target_ground_m(), violations);
  if (proto.has_place_limbs()) options.place_limbs = proto.place_limbs();
  if (proto.has_plant_feet()) options.plant_feet = proto.plant_feet();
  if (proto.has_keep_limits()) options.keep_limits = proto.keep_limits();
  options.contact_thresholds =
      ReadThresholds(proto.contact_thresholds(), violations);
  if (proto.has_root_scale()) options.root_scale = proto.root_scale();
  options.instruction_set = level;
  return options;
}

void ToProto(const std::array<Contact, kFootPointCount>& contacts,
             v1::FootContact* proto) {
  proto->set_heel(contacts[kHeel] != Contact::kNone);
  proto->set_ball(contacts[kBall] != Contact::kNone);
  proto->set_tip(contacts[kTip] != Contact::kNone);
}

}  // namespace

absl::StatusOr<LiveRetargetSpec> FromProto(const v1::Retargeting& proto,
                                           const RetargetedSkeletons& skeletons,
                                           InstructionSet level) {
  Violations violations;
  LiveRetargetSpec spec;
  spec.target =
      ReadModel(proto.joint_map(), MapSide::kTarget, skeletons.target,
                proto.target_calibration(), "target_calibration", violations);
  if (skeletons.source != nullptr) {
    spec.source =
        ReadModel(proto.joint_map(), MapSide::kSource, skeletons.source,
                  proto.source_calibration(), "source_calibration", violations);
  } else if (spec.target != nullptr) {
    spec.trackers = ReadTrackers(proto.trackers(), *spec.target, violations);
  }
  spec.options = ReadOptions(proto, level, violations);
  if (proto.has_frame_time_s()) spec.frame_time_s = proto.frame_time_s();
  if (!violations.empty()) return violations.ToStatus();
  return spec;
}

void ToProto(const LiveRetargeter& retargeter, v1::Retargeting* proto) {
  const LiveRetargetSpec& spec = retargeter.spec();
  const RetargetOptions& options = spec.options;
  const BodyModel& source = retargeter.source();
  const BodyModel& target = retargeter.target();
  ToProto({source.map, *source.skeleton}, {target.map, *target.skeleton},
          proto->mutable_joint_map());
  if (spec.trackers) {
    proto->mutable_trackers()->set_height_m(spec.trackers->height_m);
  }
  if (options.root_scale) proto->set_root_scale(*options.root_scale);
  if (options.source_ground != nullptr) {
    proto->set_source_ground_m(options.source_ground->HeightAt(0, 0));
  }
  if (options.target_ground != nullptr) {
    proto->set_target_ground_m(options.target_ground->HeightAt(0, 0));
  }
  proto->set_place_limbs(options.place_limbs);
  proto->set_plant_feet(options.plant_feet);
  proto->set_keep_limits(options.keep_limits);
  v1::ContactThresholds* thresholds = proto->mutable_contact_thresholds();
  thresholds->set_max_height_on_m(options.contact_thresholds.max_height_on);
  thresholds->set_max_height_off_m(options.contact_thresholds.max_height_off);
  thresholds->set_max_speed_on_m_per_s(options.contact_thresholds.max_speed_on);
  thresholds->set_max_speed_off_m_per_s(
      options.contact_thresholds.max_speed_off);
  proto->set_frame_time_s(spec.frame_time_s);
}

void ToFollowedReport(absl::Duration duration, v1::SolveReport* proto) {
  proto->set_outcome(v1::SolveReport::OUTCOME_CONVERGED);
  ToProto(duration, proto->mutable_solve_duration());
}

void ToProto(const RetargetReport& report, v1::RetargetReport* proto) {
  ToProto(report.contacts[kLeft], proto->mutable_left_foot());
  ToProto(report.contacts[kRight], proto->mutable_right_foot());
  proto->set_source_ground_m(report.source_floor_m);
  ToProto(report.pelvis_shift, proto->mutable_pelvis_shift());
  proto->set_left_hand_error_m(report.hand_error_m[kLeft]);
  proto->set_right_hand_error_m(report.hand_error_m[kRight]);
  proto->set_left_foot_error_m(report.foot_error_m[kLeft]);
  proto->set_right_foot_error_m(report.foot_error_m[kRight]);
  proto->set_limit_excess(report.limit_excess);
}

}  // namespace gelenk::convert
