// Smooths poses as they come, on the manifold, and says how late it makes them.
//
// Three steps, each of which can be left out:
//   1. outliers (see hampel.h) are replaced: delays by `hampel->reach` frames;
//   2. kExponential moves a fixed part of the way to each new pose,
//      1 - exp(-dt / time_constant): steady motion lags by the time constant;
//      kOneEuro does so with a cutoff that grows with the speed of each part of
//      the pose: at rest it lags by 1 / (2 pi min_cutoff), in fast motion by
//      little.
// Rotations move along the shortest turn between the last output and the new
// pose. Deterministic: time comes with each pose. Push allocates nothing.
// Source: Casiez, Roussel and Vogel, "1 Euro filter" (CHI 2012).
#ifndef GELENK_MOTION_SMOOTHER_H_
#define GELENK_MOTION_SMOOTHER_H_

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "gelenk/math/state_numbers.h"
#include "gelenk/motion/hampel.h"
#include "gelenk/motion/pose_part.h"
#include "gelenk/skeleton/pose.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

struct SmootherOptions {
  enum class Kind { kNone, kExponential, kOneEuro };
  Kind kind = Kind::kOneEuro;
  // kExponential.
  double time_constant_s = 0.05;
  // kOneEuro: > 0.
  double min_cutoff_hz = 1;
  // Hz of cutoff per rad/s or m/s, >= 0.
  double speed_coefficient = 0.5;
  double speed_cutoff_hz = 1;
  std::optional<HampelOptions> hampel = std::nullopt;
};

class Smoother {
 public:
  // INVALID_ARGUMENT naming each option that is not finite or out of range.
  static absl::StatusOr<Smoother> Create(
      std::shared_ptr<const Skeleton> skeleton,
      const SmootherOptions& options = {});

  // `positions` passes CheckPositions and was captured at `time_s`, later than
  // the last; one that is not is left out. Returns false, and leaves `smooth`
  // alone, until there is a pose to give: with Hampel after `reach` frames.
  bool Push(double time_s, const ConstVectorView& positions, VectorView smooth);

  // How far the last output lags behind the last input, s: the outlier window,
  // and the most that a part of the pose lags in steady motion.
  double latency_s() const { return latency_s_; }

  // Forgets everything; keeps its memory.
  void Reset();

  // All that later outputs depend on, but for a window of outliers, which
  // begins anew. See StateNumbers.
  void Exchange(StateNumbers& state);

 private:
  Smoother(std::shared_ptr<const Skeleton> skeleton,
           const SmootherOptions& options);
  // Puts the pose into the window; true when its middle is ready in `middle_`.
  bool PassWindow(double time_s, const ConstVectorView& positions);
  // The part of the way that `part` goes after `dt_s`.
  double Gain(const PosePart& part, double dt_s);

  std::shared_ptr<const Skeleton> skeleton_;
  SmootherOptions options_;
  std::vector<PosePart> parts_;
  // A ring of the last poses, oldest at `window_next_` once it is full.
  Eigen::MatrixXd window_;
  std::vector<double> window_times_s_;
  std::vector<const double*> window_pointers_;
  int window_next_ = 0;
  int window_size_ = 0;
  Eigen::VectorXd middle_;
  double middle_time_s_ = 0;
  // Last output, last input, speed per degree of freedom.
  Eigen::VectorXd smooth_;
  Eigen::VectorXd last_;
  Eigen::VectorXd velocity_;
  Eigen::VectorXd change_;
  double last_time_s_ = 0;
  double pushed_time_s_ = 0;
  bool has_pushed_ = false;
  bool has_smooth_ = false;
  double latency_s_ = 0;
};

}  // namespace gelenk

#endif  // GELENK_MOTION_SMOOTHER_H_
