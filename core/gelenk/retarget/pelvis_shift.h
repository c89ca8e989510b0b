// Moves the pelvis so that both legs reach their feet without being
// overstretched or folded.
#ifndef GELENK_RETARGET_PELVIS_SHIFT_H_
#define GELENK_RETARGET_PELVIS_SHIFT_H_

#include <Eigen/Core>
#include <array>

#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_model.h"

namespace gelenk {

class PelvisShift {
 public:
  explicit PelvisShift(const std::array<LimbLengths, 2>& legs) : legs_(legs) {}

  void Reset() { shift_.setZero(); }
  void Exchange(StateNumbers& state) { state.Vector(shift_); }

  // The way to move the pelvis by in this frame, smoothed over time. `hips` and
  // `ankles` are those of the copied pose: legs that are straight there stay
  // straight. `goals` are where the ankles shall be. Allocates nothing.
  Eigen::Vector3d Update(const std::array<Eigen::Vector3d, 2>& hips,
                         const std::array<Eigen::Vector3d, 2>& ankles,
                         const std::array<Eigen::Vector3d, 2>& goals,
                         double dt_s);

 private:
  std::array<LimbLengths, 2> legs_;
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero();
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_PELVIS_SHIFT_H_
