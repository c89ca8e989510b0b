#include "gelenk/retarget/reference_pose.h"

#include <algorithm>
#include <cmath>

namespace gelenk {
namespace {

constexpr int kMaxSampledFrames = 400;
// A left that is nearer than 14 degrees to an axis is that axis.
constexpr double kAlmostAnAxis = 0.97;
constexpr double kNoLength = 1e-9;

Eigen::Vector3d NearestAxis(const Eigen::Vector3d& v) {
  int axis = 0;
  v.cwiseAbs().maxCoeff(&axis);
  return (v[axis] < 0 ? -1 : 1) * Eigen::Vector3d::Unit(axis);
}

// The joints of a posed body by their roles.
class PosedBody {
 public:
  PosedBody(const Skeleton& skeleton, const JointMap& map,
            const Eigen::VectorXd& positions)
      : map_(map) {
    ForwardKinematics(skeleton, positions, world_from_joints_);
  }

  bool Has(BodyRole role) const { return map_.Has(role); }
  const Eigen::Vector3d& At(BodyRole role) const {
    return world_from_joints_[map_.joint(role)].translation;
  }
  Eigen::Vector3d Direction(BodyRole from, BodyRole to) const {
    return (At(to) - At(from)).stableNormalized();
  }
  // From the right to the left one; zero without both.
  Eigen::Vector3d Across(BodyRole left, BodyRole right) const {
    if (!Has(left) || !Has(right)) return Eigen::Vector3d::Zero();
    return At(left) - At(right);
  }
  Eigen::Vector3d Hips() const {
    return Across(BodyRole::kLeftThigh, BodyRole::kRightThigh);
  }
  Eigen::Vector3d Shoulders() const {
    return Across(BodyRole::kLeftUpperArm, BodyRole::kRightUpperArm);
  }

  // From the feet, or what there is of the legs, to the top.
  Eigen::Vector3d Upwards() const {
    const BodyRole top = Has(BodyRole::kHead)    ? BodyRole::kHead
                         : Has(BodyRole::kChest) ? BodyRole::kChest
                                                 : BodyRole::kPelvis;
    if (!Has(top)) return Eigen::Vector3d::UnitY();
    Eigen::Vector3d bottom = Eigen::Vector3d::Zero();
    if (Has(BodyRole::kLeftFoot) && Has(BodyRole::kRightFoot)) {
      bottom = (At(BodyRole::kLeftFoot) + At(BodyRole::kRightFoot)) / 2;
    } else if (Has(BodyRole::kPelvis)) {
      bottom = At(BodyRole::kPelvis);
    }
    const Eigen::Vector3d upwards = At(top) - bottom;
    if (upwards.norm() < kNoLength) return Eigen::Vector3d::UnitY();
    return upwards;
  }

 private:
  const JointMap& map_;
  WorldTransforms world_from_joints_;
};

// The least of several grades; each is 1 where `value` is `perfect` or beyond,
// 0 at `bad`.
class Grades {
 public:
  void Add(double value, double bad, double perfect) {
    least_ = std::min(least_, (value - bad) / (perfect - bad));
  }
  double least() const { return least_; }

 private:
  double least_ = 1;
};

void GradeLeg(const PosedBody& body, const LegRoles& leg,
              const Eigen::Vector3d& up, Grades& grades) {
  grades.Add(-up.dot(body.Direction(leg.thigh, leg.shin)), 0.75, 1);
  grades.Add(-up.dot(body.Direction(leg.shin, leg.foot)), 0.75, 1);
}

// `outwards` is away from the body.
void GradeArm(const PosedBody& body, const ArmRoles& arm,
              const Eigen::Vector3d& up, const Eigen::Vector3d& outwards,
              const Eigen::Vector3d& forward, Grades& grades) {
  const Eigen::Vector3d upper = body.Direction(arm.upper_arm, arm.forearm);
  const Eigen::Vector3d lower = body.Direction(arm.forearm, arm.hand);
  grades.Add(-std::abs(upper.dot(forward)), -0.6, 0);
  grades.Add(upper.dot(lower), 0.5, 1);
  grades.Add(std::max(upper.dot(outwards), -up.dot(upper)), 0.3, 0.8);
}

}  // namespace

ReferencePose ScorePose(const Skeleton& skeleton, const JointMap& map,
                        const Eigen::VectorXd& positions,
                        const std::optional<Eigen::Vector3d>& up) {
  const PosedBody body(skeleton, map, positions);
  ReferencePose pose;
  pose.positions = positions;
  pose.up = up ? *up : NearestAxis(body.Upwards());
  const Eigen::Vector3d hips = body.Hips();
  const Eigen::Vector3d shoulders = body.Shoulders();
  pose.left = hips.norm() > kNoLength ? hips : shoulders;
  pose.left -= pose.left.dot(pose.up) * pose.up;
  if (pose.left.norm() < kNoLength) {
    // Neither legs nor arms tell; or a body that lies on its side.
    pose.left = pose.up.unitOrthogonal();
    pose.score = map.HasLegs() ? -1 : 0;
    return pose;
  }
  pose.left.normalize();

  const Eigen::Vector3d forward = pose.left.cross(pose.up);
  Grades grades;
  for (int side : kSides) {
    if (map.HasLeg(side)) GradeLeg(body, kLegRoles[side], pose.up, grades);
    if (map.HasArm(side)) {
      GradeArm(body, kArmRoles[side], pose.up,
               side == kLeft ? pose.left : Eigen::Vector3d(-pose.left), forward,
               grades);
    }
  }
  if (hips.norm() > kNoLength && shoulders.norm() > kNoLength) {
    grades.Add(hips.normalized().dot(shoulders.normalized()), 0.7, 1);
  }
  if (body.Has(BodyRole::kPelvis) && body.Has(BodyRole::kChest)) {
    grades.Add(pose.up.dot(body.Direction(BodyRole::kPelvis, BodyRole::kChest)),
               0.7, 1);
  }
  pose.score = grades.least();
  return pose;
}

ReferencePose FindReferencePose(const Skeleton& skeleton, const JointMap& map,
                                const ClipView* clip) {
  ReferencePose best =
      ScorePose(skeleton, map, skeleton.rest_positions(), std::nullopt);
  const Eigen::Vector3d axis = NearestAxis(best.left);
  if (axis.dot(best.left) > kAlmostAnAxis) best.left = axis;
  if (best.score > 0 || clip == nullptr || clip->frame_count() == 0) {
    return best;
  }
  // A first frame that is no motion is welcome here.
  const int step = std::max(1, clip->frame_count() / kMaxSampledFrames);
  for (int frame = 0; frame < clip->frame_count(); frame += step) {
    ReferencePose pose =
        ScorePose(skeleton, map, clip->positions.col(frame), skeleton.up());
    if (!best.IsRestPose() && pose.score <= best.score) continue;
    best = std::move(pose);
    best.frame = frame;
  }
  return best;
}

}  // namespace gelenk
