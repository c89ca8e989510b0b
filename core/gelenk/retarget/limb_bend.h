// Puts the end of an arm or leg where it should be, in closed form, and
// remembers how it bends.
//
// Starting from the copied rotations the limb is turned by the shortest
// rotation onto the new direction of its end, then bent in its plane. A
// straight limb has no plane: its normal is kept in the frame of the upper
// bone and renewed as strongly as the limb is bent, at a limited speed; without
// that memory straight elbows and knees flip by 40 degrees in a frame. Limbs
// that bend backwards a little are noise; those that bend backwards much are
// rigs that do so.
#ifndef GELENK_RETARGET_LIMB_BEND_H_
#define GELENK_RETARGET_LIMB_BEND_H_

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"

namespace gelenk {

// A limb never reaches farther than this part of its length, ...
inline constexpr double kMaxLimbReach = 0.9998;
// ... and never nearer than its bones' difference and this part of it.
inline constexpr double kMinLimbReach = 0.03;

struct LimbPose {
  // Canonical orientations of the joints of the two bones, changed by Bend.
  Eigen::Quaterniond upper;
  Eigen::Quaterniond lower;
  // Where the limb is.
  Eigen::Vector3d root;
  Eigen::Vector3d middle;
  Eigen::Vector3d end;
};

class LimbBend {
 public:
  // `hinge` is the axis about which the limb bends in the anatomical frame of
  // its upper bone; `anatomy` that bone's.
  LimbBend(const LimbLengths& lengths, const Eigen::Vector3d& hinge,
           const Eigen::Quaterniond& anatomy)
      : lengths_(lengths), hinge_(hinge), anatomy_(anatomy), normal_(hinge) {}

  void Reset() {
    normal_ = hinge_;
    is_first_ = true;
  }

  void Exchange(StateNumbers& state) {
    state.Vector(normal_);
    state.Flag(is_first_);
  }

  // Turns the bones so that the end comes to `goal`, or as near as it can.
  // Allocates nothing.
  void Bend(const Eigen::Vector3d& goal, double dt_s, LimbPose& limb);

 private:
  // Renews the normal by that of the copied pose.
  void Remember(const Eigen::Vector3d& bend,
                const Eigen::Quaterniond& anatomical, double dt_s);

  LimbLengths lengths_;
  Eigen::Vector3d hinge_;
  Eigen::Quaterniond anatomy_;
  // Unit, in the anatomical frame of the upper bone.
  Eigen::Vector3d normal_;
  bool is_first_ = true;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_LIMB_BEND_H_
