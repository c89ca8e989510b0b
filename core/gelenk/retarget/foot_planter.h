// Keeps one foot where it stands, without look-ahead.
//
// When a point of the foot comes into contact it is locked where the corrected
// foot has it at that moment, so that nothing pops, and its height eases to
// that of a planted point. One lock holds the point and lets the foot turn; two
// hold the foot. What the locks have moved fades out when they are released.
// Without locks the foot is lifted out of the ground, with one it is turned out
// of it. The toe's tip is held the same way while the ball is.
#ifndef GELENK_RETARGET_FOOT_PLANTER_H_
#define GELENK_RETARGET_FOOT_PLANTER_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>

#include "gelenk/contact/contact_detector.h"
#include "gelenk/contact/ground.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"

namespace gelenk {

// Canonical: of the foot's joint.
struct FootPose {
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d ankle = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return ankle + orientation * point;
  }
};

// The shape of a foot and what it stands on. Keeps references.
struct FootOnGround {
  const FootShape& shape;
  const std::array<double, kFootPointCount>& planted_heights;
  const Ground& ground;

  // Of a planted `point` (kHeel, kBall, kTip) that is at `at`.
  double PlantedHeight(int point, const Eigen::Vector3d& at) const {
    return ground.HeightAt(at) + planted_heights[point];
  }
};

// Moves a foot out of the ground: up, or about its heel or ball when `locked`
// is one of them.
inline constexpr int kNothingLocked = -1;
void LiftFoot(const FootOnGround& foot, int locked, FootPose& pose);

// Turns the toe about `ball` so that its tip is not below the ground.
Eigen::Quaterniond LiftToe(const FootOnGround& foot,
                           const Eigen::Vector3d& ball,
                           const Eigen::Quaterniond& toe);

// Keeps the toe of one foot out of the ground, and its tip where it stands.
class ToePlanter {
 public:
  explicit ToePlanter(const FootOnGround& foot) : foot_(foot) {}

  void Reset() {
    tip_is_held_ = false;
    turned_.setIdentity();
    is_first_ = true;
  }

  void Exchange(StateNumbers& state);

  // What the foot does below the toe.
  struct Foot {
    // How far it is turned beside its goal.
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
    bool holds_ball = false;
    bool holds_heel = false;
  };

  // `wanted` is the orientation of the toe in the copied pose. Toes turn at a
  // limited speed; what that leaves in the ground lifts `pose` where nothing
  // holds the foot. Allocates nothing.
  Eigen::Quaterniond Plant(const Foot& foot, const Eigen::Quaterniond& wanted,
                           Contact tip, double dt_s, FootPose& pose);

 private:
  // Turns `toe` onto the place where the tip stands.
  void HoldTip(const Eigen::Vector3d& ball, bool holds, double dt_s,
               Eigen::Quaterniond& toe);

  FootOnGround foot_;
  bool tip_is_held_ = false;
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();
  // The toe beside the wanted one.
  Eigen::Quaterniond turned_ = Eigen::Quaterniond::Identity();
  bool is_first_ = true;
};

class FootPlanter {
 public:
  // `size` as BodyModel::Size of the target. All referred to must outlive it.
  FootPlanter(const FootOnGround& foot, double size)
      : foot_(foot), size_(size), toe_(foot) {}

  void Reset() {
    locks_ = {};
    moved_.setZero();
    turned_.setIdentity();
    toe_.Reset();
    is_first_ = true;
  }

  void Exchange(StateNumbers& state);

  // Where the foot is to be, given where it would be. Allocates nothing.
  FootPose Plant(const FootPose& goal,
                 const std::array<Contact, kFootPointCount>& contacts,
                 double dt_s);

  // The toe of the foot that Plant gave last; see ToePlanter. What it lifts
  // fades like everything that is moved.
  Eigen::Quaterniond PlantToe(
      const Eigen::Quaterniond& wanted,
      const std::array<Contact, kFootPointCount>& contacts, double dt_s,
      FootPose& planted);

 private:
  struct Lock {
    bool is_on = false;
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    double age_s = 0;
  };

  const Eigen::Vector3d& PointOf(int point) const {
    return point == kHeel ? foot_.shape.heel : foot_.shape.ball;
  }
  void UpdateLock(int point, bool in_contact, const FootPose& goal,
                  const FootPose& pose, double dt_s);
  // The foot on both locks.
  void StandOnBoth(FootPose& pose);
  FootOnGround foot_;
  double size_;
  // Of heel and ball.
  std::array<Lock, 2> locks_;
  ToePlanter toe_;
  // What the locks have moved: ankle and orientation beside those wanted.
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond turned_ = Eigen::Quaterniond::Identity();
  // Nothing can pop in a first frame: feet stand at once.
  bool is_first_ = true;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_FOOT_PLANTER_H_
