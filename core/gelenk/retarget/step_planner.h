// Feet for a body of which only the upper half is tracked: they stand until the
// hips have gone or turned too far, then step after them, one at a time.
#ifndef GELENK_RETARGET_STEP_PLANNER_H_
#define GELENK_RETARGET_STEP_PLANNER_H_

#include <Eigen/Core>
#include <array>

#include "gelenk/math/state_numbers.h"
#include "gelenk/retarget/body_role.h"

namespace gelenk {

// Canonical, of the ankle: where it is and where the foot points, rad from +Z
// to +X.
struct SteppingFoot {
  Eigen::Vector3d ankle = Eigen::Vector3d::Zero();
  double yaw_rad = 0;

  void Exchange(StateNumbers& state) {
    state.Vector(ankle);
    state.Number(yaw_rad);
  }
};

class StepPlanner {
 public:
  // `stance_width_m` between the ankles, `ankle_height_m` above the ground at
  // height 0. `size` scales the thresholds, 1 for an adult.
  StepPlanner(double stance_width_m, double ankle_height_m, double size)
      : half_width_m_(stance_width_m / 2),
        ankle_height_m_(ankle_height_m),
        size_(size) {}

  // The next frame's feet below hips at `hips` that look along `yaw_rad`. The
  // first frame stands. Allocates nothing.
  const std::array<SteppingFoot, 2>& Update(const Eigen::Vector3d& hips,
                                            double yaw_rad, double dt_s);

  void Reset() { is_first_ = true; }
  void Exchange(StateNumbers& state);

 private:
  struct Step {
    bool is_on = false;
    double time_s = 0;
    SteppingFoot from;
  };

  SteppingFoot Home(int side, const Eigen::Vector3d& hips,
                    double yaw_rad) const;
  void Advance(int side, const SteppingFoot& home, double dt_s);
  // How far a standing foot is from home; 1 is too far.
  double Strain(int side, const SteppingFoot& home) const;

  double half_width_m_;
  double ankle_height_m_;
  double size_;
  std::array<SteppingFoot, 2> feet_;
  std::array<Step, 2> steps_;
  Eigen::Vector3d last_hips_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  bool is_first_ = true;
};

}  // namespace gelenk

#endif  // GELENK_RETARGET_STEP_PLANNER_H_
