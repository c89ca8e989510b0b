#include "gelenk/retarget/body_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_format.h"
#include "gelenk/kinematics/forward_kinematics.h"
#include "gelenk/math/rotation.h"
#include "gelenk/retarget/clip_anatomy.h"

namespace gelenk {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
// A reference that scores worse is no standing body at all.
constexpr double kMinReferenceScore = -1;
// Motion that is too short to tell axes and soles.
constexpr int kMinHingeFrames = 6;
constexpr int kMinLevelFrames = 11;
// A rest foot that is tilted more than this is levelled by the clip.
constexpr double kMaxRestTilt = 5 * kDegree;

// Of the leg of a body of which the legs are missing: legs are as long as the
// way from the pelvis to the head, arms 0.65 of a leg.
constexpr double kLegByTrunk = 1;
constexpr double kArmByLeg = 0.65;

// Feet, relative to kReferenceLegM: the ball of a foot of which nothing is
// known, from the ankle; the least height of the ankle and length of the foot;
// how far the heel is behind the ankle, relative to the ball before it.
const Vector3d kUnknownBall(0, -0.06, 0.14);
constexpr double kMinFootBone = 0.02;
constexpr double kMinFootLength = 0.05;
constexpr double kMinAnkleByLeg = 0.02;
constexpr double kHeelByBall = 0.25;
constexpr double kMinTipByLeg = 0.01;
// A ball that is less than this part of its distance ahead does not tell where
// the foot points.
constexpr double kMinForwardPart = 0.3;

class BodyModelMaker {
 public:
  BodyModelMaker(std::shared_ptr<const Skeleton> skeleton, const JointMap& map,
                 const ClipView* clip, const BodyModelOptions& options)
      : clip_(clip), options_(options) {
    model_.skeleton = std::move(skeleton);
    model_.map = map;
    model_.notes = map.notes;
  }

  absl::StatusOr<std::shared_ptr<const BodyModel>> Make() {
    if (absl::Status status = TakeReference(); !status.ok()) return status;
    model_.canonical_from_world =
        ShortestRotation(skeleton().up(), Vector3d::UnitY());
    TakePlacesAndLengths();
    TakeAnatomy();
    LearnFromClip();
    for (int side : kSides) {
      if (model_.map.HasLeg(side)) ShapeFoot(side);
    }
    return std::make_shared<const BodyModel>(std::move(model_));
  }

 private:
  const Skeleton& skeleton() const { return *model_.skeleton; }
  int joint(BodyRole role) const { return model_.map.joint(role); }
  const Vector3d& At(int joint) const { return reference_[joint].translation; }

  absl::Status TakeReference() {
    const JointMap& map = model_.map;
    if (!map.Has(BodyRole::kPelvis) && !map.HasArm(kLeft) &&
        !map.HasArm(kRight)) {
      return absl::InvalidArgumentError(
          "joint_map: neither a pelvis nor an arm is known: this is no body");
    }
    if (options_.reference_positions) {
      Eigen::VectorXd positions = *options_.reference_positions;
      if (absl::Status status = CheckPositions(skeleton(), positions);
          !status.ok()) {
        return status;
      }
      model_.reference = ScorePose(skeleton(), map, positions, std::nullopt);
    } else {
      model_.reference = FindReferencePose(skeleton(), map, clip_);
      if (model_.reference.score < kMinReferenceScore) {
        return absl::InvalidArgumentError(absl::StrFormat(
            "reference_positions: the rest pose is not one of a standing body "
            "(it scores %.2f, want > 0)%s; give a pose that is",
            model_.reference.score,
            clip_ == nullptr ? " and there is no clip" : ", nor is any frame"));
      }
    }
    if (!model_.reference.IsRestPose()) {
      model_.notes.push_back(absl::StrFormat(
          "the rest pose is not of a standing body: frame %d is the reference",
          model_.reference.frame));
    }
    ForwardKinematics(skeleton(), model_.reference.positions, reference_);
    return absl::OkStatus();
  }

  double Distance(BodyRole from, BodyRole to) const {
    return (At(joint(to)) - At(joint(from))).norm();
  }

  // The length of the bones from below `top` to each joint of `chain`.
  std::vector<double> Ways(const std::vector<int>& chain) const {
    std::vector<double> ways;
    double way = 0;
    for (int i : chain) {
      way += (At(i) - At(skeleton().span(i).parent)).norm();
      ways.push_back(way);
    }
    return ways;
  }

  void TakePlacesAndLengths() {
    for (int i = 0; i < skeleton().joint_count(); ++i) {
      model_.parent_from_joint.push_back(
          skeleton().joint(i).parent_from_joint *
          JointMotion(skeleton(), i, model_.reference.positions));
    }
    const JointMap& map = model_.map;
    for (int side : kSides) {
      const LegRoles& leg = kLegRoles[side];
      const ArmRoles& arm = kArmRoles[side];
      if (map.HasLeg(side)) {
        model_.legs[side] = {Distance(leg.thigh, leg.shin),
                             Distance(leg.shin, leg.foot)};
      }
      if (map.HasArm(side)) {
        model_.arms[side] = {Distance(arm.upper_arm, arm.forearm),
                             Distance(arm.forearm, arm.hand)};
      }
    }
    TakeTrunk();
    TakeLegLength();
  }

  void TakeTrunk() {
    const JointMap& map = model_.map;
    std::vector<double> spine = Ways(map.spine);
    trunk_length_ = spine.empty() ? 0 : spine.back();
    for (double way : spine) {
      model_.spine_fractions.push_back(trunk_length_ > 0 ? way / trunk_length_
                                                         : 1);
    }
    if (!map.Has(BodyRole::kHead)) return;
    std::vector<int> to_head = map.neck;
    to_head.push_back(map.joint(BodyRole::kHead));
    const std::vector<double> neck = Ways(to_head);
    for (size_t i = 0; i < map.neck.size(); ++i) {
      model_.neck_fractions.push_back(neck.back() > 0 ? neck[i] / neck.back()
                                                      : 1);
    }
    trunk_length_ += neck.back();
  }

  void TakeLegLength() {
    double sum = 0;
    int count = 0;
    for (int side : kSides) {
      if (!(model_.legs[side].Total() > 0)) continue;
      sum += model_.legs[side].Total();
      ++count;
    }
    if (count > 0) {
      model_.leg_length = sum / count;
    } else if (trunk_length_ > 0) {
      model_.leg_length = kLegByTrunk * trunk_length_;
    } else {
      model_.leg_length =
          std::max(model_.arms[kLeft].Total(), model_.arms[kRight].Total()) /
          kArmByLeg;
    }
    if (!(model_.leg_length > 0)) model_.leg_length = kReferenceLegM;
  }

  // Canonical direction of a bone in the reference pose.
  Vector3d BoneDirection(BodyRole from, BodyRole to) const {
    return canonical_from_reference_ *
           (At(joint(to)) - At(joint(from))).stableNormalized();
  }

  // Of a lower bone: first the turn of the upper one, then the bend straight.
  Quaterniond StraightenOn(const Quaterniond& upper, BodyRole from, BodyRole to,
                           const Vector3d& wanted) const {
    return ShortestRotation(upper * BoneDirection(from, to), wanted) * upper;
  }

  void Turn(BodyRole role, const Quaterniond& turn) {
    Quaterniond& anatomy = model_.anatomy[joint(role)];
    anatomy = turn * anatomy;
  }

  void TakeAnatomy() {
    Eigen::Matrix3d rows;
    rows.row(0) = model_.reference.left;
    rows.row(1) = model_.reference.up;
    rows.row(2) = model_.reference.left.cross(model_.reference.up);
    canonical_from_reference_ = Quaterniond(rows).normalized();
    for (const RigidTransform& world_from_joint : reference_) {
      model_.anatomy.push_back(canonical_from_reference_ *
                               world_from_joint.rotation);
    }
    const Vector3d down = -Vector3d::UnitY();
    for (int side : kSides) {
      const LegRoles& leg = kLegRoles[side];
      const ArmRoles& arm = kArmRoles[side];
      if (model_.map.HasLeg(side)) {
        const Quaterniond thigh =
            ShortestRotation(BoneDirection(leg.thigh, leg.shin), down);
        const Quaterniond shin = StraightenOn(thigh, leg.shin, leg.foot, down);
        Turn(leg.thigh, thigh);
        Turn(leg.shin, shin);
      }
      if (model_.map.HasArm(side)) {
        const Vector3d outwards = (side == kLeft ? 1 : -1) * Vector3d::UnitX();
        const Quaterniond upper_arm = ShortestRotation(
            BoneDirection(arm.upper_arm, arm.forearm), outwards);
        const Quaterniond forearm =
            StraightenOn(upper_arm, arm.forearm, arm.hand, outwards);
        Turn(arm.upper_arm, upper_arm);
        Turn(arm.forearm, forearm);
        Turn(arm.hand, forearm);
      }
      if (model_.map.HasLeg(side)) PointForward(side);
    }
  }

  // From the ankle to the ball, in the foot's frame: to the toes, else to the
  // foremost end effector; zero when there is none.
  Vector3d FootFromBall(int side) const {
    const int foot = joint(kLegRoles[side].foot);
    const int toe = joint(kLegRoles[side].toe);
    if (toe >= 0) return reference_[foot].Inverse() * At(toe);
    Vector3d ball = Vector3d::Zero();
    for (int i = foot + 1; i < skeleton().joint_count(); ++i) {
      if (skeleton().span(i).parent != foot) continue;
      const Vector3d place = reference_[foot].Inverse() * At(i);
      if (place.norm() > ball.norm()) ball = place;
    }
    for (const EndEffector& effector : skeleton().end_effectors()) {
      if (skeleton().FindJoint(effector.joint_id) != foot) continue;
      if (IsHeel(effector)) continue;
      const Vector3d& place = effector.joint_from_end_effector.translation;
      if (place.norm() > ball.norm()) ball = place;
    }
    return ball;
  }

  static bool IsHeel(const EndEffector& effector) {
    return absl::StrContains(absl::AsciiStrToLower(effector.id), "heel");
  }

  std::optional<Vector3d> FootFromHeel(int foot) const {
    for (const EndEffector& effector : skeleton().end_effectors()) {
      if (IsHeel(effector) && skeleton().FindJoint(effector.joint_id) == foot) {
        return effector.joint_from_end_effector.translation;
      }
    }
    return std::nullopt;
  }

  // From the toe joint to the tip, in the toe's frame; zero when there is none.
  Vector3d ToeFromTip(int toe) const {
    for (int i = toe + 1; i < skeleton().joint_count(); ++i) {
      if (skeleton().span(i).parent != toe) continue;
      return reference_[toe].Inverse() * At(i);
    }
    for (const EndEffector& effector : skeleton().end_effectors()) {
      if (skeleton().FindJoint(effector.joint_id) == toe) {
        return effector.joint_from_end_effector.translation;
      }
    }
    return Vector3d::Zero();
  }

  void PointForward(int side) {
    const LegRoles& leg = kLegRoles[side];
    const Vector3d ball = model_.anatomy[joint(leg.foot)] * FootFromBall(side);
    const Vector3d ahead = Horizontal(ball);
    if (!(ahead.norm() > kMinForwardPart * ball.norm())) return;
    const Quaterniond yaw =
        ShortestRotation(ahead.normalized(), Vector3d::UnitZ());
    for (BodyRole role : {leg.foot, leg.toe}) {
      if (!model_.map.Has(role)) continue;
      model_.anatomy[joint(role)] = yaw * model_.anatomy[joint(role)];
    }
  }

  void Note(std::vector<std::string> notes) {
    for (std::string& note : notes) model_.notes.push_back(std::move(note));
  }

  void LearnFromClip() {
    if (clip_ == nullptr) return;
    const int count = clip_->frame_count() - clip_->first_frame;
    const bool is_rest = model_.reference.IsRestPose() &&
                         !options_.reference_positions.has_value();
    if (!is_rest && count >= kMinHingeFrames) {
      Note(AlignHinges(skeleton(), model_.map, *clip_, model_.anatomy));
    }
    if (options_.flat_feet == FlatFeet::kOff) return;
    if (count < kMinLevelFrames) return;
    const bool always = options_.flat_feet == FlatFeet::kOn || !is_rest;
    std::array<Vector3d, 2> balls = {Vector3d::Zero(), Vector3d::Zero()};
    for (int side : kSides) {
      if (model_.map.HasLeg(side)) balls[side] = FootFromBall(side);
    }
    Note(LevelFeet(skeleton(), model_.map, *clip_, balls, model_.leg_length,
                   always ? 0 : kMaxRestTilt, model_.anatomy));
  }

  void ShapeFoot(int side) {
    const LegRoles& leg = kLegRoles[side];
    const int foot = joint(leg.foot);
    const int toe = joint(leg.toe);
    const double size = model_.Size();
    FootShape& shape = model_.feet[side];

    Vector3d ball = model_.anatomy[foot] * FootFromBall(side);
    if (ball.norm() < kMinFootBone * size) {
      ball = kUnknownBall * size;
      model_.notes.push_back(absl::StrFormat(
          "%s has no toes: its shape is assumed", BodyRoleName(leg.foot)));
    } else if (Horizontal(ball).norm() < kMinFootLength * size) {
      // The foot's bone goes straight down: only its height is told.
      ball = Vector3d(ball.x(), ball.y(), kUnknownBall.z() * size);
    }
    Vector3d tip = Vector3d::Zero();
    if (toe >= 0) {
      shape.tip = ToeFromTip(toe);
      shape.has_tip = shape.tip.norm() > kMinTipByLeg * model_.leg_length;
      if (shape.has_tip) tip = model_.anatomy[toe] * shape.tip;
    }
    double sole = ball.y();
    if (shape.has_tip) sole = std::min(sole, ball.y() + tip.y());
    Vector3d heel;
    if (const std::optional<Vector3d> given = FootFromHeel(foot)) {
      heel = model_.anatomy[foot] * *given;
      sole = std::min(sole, heel.y());
    } else {
      heel = Vector3d(0, 0, 0) - kHeelByBall * Horizontal(ball);
    }
    sole = std::min(sole, -kMinAnkleByLeg * model_.leg_length);
    if (!FootFromHeel(foot)) heel.y() = sole;

    shape.ankle_height = -sole;
    shape.heel = model_.anatomy[foot].conjugate() * heel;
    shape.ball = model_.anatomy[foot].conjugate() * ball;
    auto& planted = model_.planted_heights[side];
    planted[kHeel] = heel.y() - sole;
    planted[kBall] = ball.y() - sole;
    planted[kTip] = shape.has_tip ? ball.y() + tip.y() - sole : planted[kBall];
  }

  const ClipView* clip_;
  const BodyModelOptions& options_;
  BodyModel model_;
  WorldTransforms reference_;
  Quaterniond canonical_from_reference_ = Quaterniond::Identity();
  double trunk_length_ = 0;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const BodyModel>> MakeBodyModel(
    std::shared_ptr<const Skeleton> skeleton, const JointMap& map,
    const ClipView* clip, const BodyModelOptions& options) {
  return BodyModelMaker(std::move(skeleton), map, clip, options).Make();
}

}  // namespace gelenk
