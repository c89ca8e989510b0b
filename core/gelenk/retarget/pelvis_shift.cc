#include "gelenk/retarget/pelvis_shift.h"

#include <algorithm>
#include <cmath>

#include "gelenk/retarget/limb_bend.h"

namespace gelenk {

using Eigen::Vector3d;

namespace {

// A leg is stretched as far as this part of its length, or as in the copied
// pose; after smoothing a little more.
constexpr double kSoftReach = 0.985;
constexpr double kHardReach = 0.994;
constexpr double kFullReach = 0.9995;
// Just beyond what LimbBend can fold.
constexpr double kFoldMargin = 0.001;
constexpr double kSmoothTime_s = 0.05;
constexpr int kMaxRounds = 40;
constexpr double kCloseEnough = 1e-7;

struct Reach {
  double least;
  double most;
};

// Moves `shift` until both legs can reach, one after the other.
void Project(const std::array<Vector3d, 2>& hips,
             const std::array<Vector3d, 2>& goals,
             const std::array<Reach, 2>& reach, Vector3d& shift) {
  for (int round = 0; round < kMaxRounds; ++round) {
    double worst = 0;
    for (int side : kSides) {
      const Vector3d leg = goals[side] - (hips[side] + shift);
      const double length = leg.norm();
      const double excess = length > reach[side].most
                                ? length - reach[side].most
                                : std::min(0.0, length - reach[side].least);
      if (excess == 0) continue;
      shift += leg.stableNormalized() * excess;
      worst = std::max(worst, std::abs(excess));
    }
    if (worst < kCloseEnough) return;
  }
}

}  // namespace

Vector3d PelvisShift::Update(const std::array<Vector3d, 2>& hips,
                             const std::array<Vector3d, 2>& ankles,
                             const std::array<Vector3d, 2>& goals,
                             double dt_s) {
  std::array<Reach, 2> reach;
  for (int side : kSides) {
    const double total = legs_[side].Total();
    const double copied = (ankles[side] - hips[side]).norm();
    reach[side].most =
        std::max(kSoftReach * total, std::min(copied, kFullReach * total));
    reach[side].least = std::abs(legs_[side].upper - legs_[side].lower) +
                        (kMinLimbReach + kFoldMargin) * total;
  }
  Vector3d wanted = Vector3d::Zero();
  Project(hips, goals, reach, wanted);
  shift_ += (wanted - shift_) * (1 - std::exp(-dt_s / kSmoothTime_s));
  for (int side : kSides) {
    reach[side].most =
        std::max(reach[side].most, kHardReach * legs_[side].Total());
  }
  Vector3d shift = shift_;
  Project(hips, goals, reach, shift);
  return shift;
}

}  // namespace gelenk
