#include "gelenk/contact/point_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gelenk {
namespace {

// The mean is over so many seconds.
constexpr double kMemory_s = 0.5;
// 1 + 9 + 9 + 1, and three axes.
constexpr double kVarianceOfDifference = 20 * 3;

}  // namespace

void PointNoise::Update(const FootPoints& points, double dt_s) {
  if (count_ == kBefore) {
    double least = std::numeric_limits<double>::infinity();
    for (int side = 0; side < 2; ++side) {
      for (int point = 0; point < kFootPointCount; ++point) {
        const Eigen::Vector3d third =
            points[side][point] - before_[2][side][point] +
            3 * (before_[1][side][point] - before_[0][side][point]);
        least = std::min(least, third.squaredNorm());
      }
    }
    variance_ += (least / kVarianceOfDifference - variance_) *
                 (1 - std::exp(-dt_s / kMemory_s));
  } else {
    ++count_;
  }
  before_ = {points, before_[0], before_[1]};
}

double PointNoise::deviation_m() const { return std::sqrt(variance_); }

void PointNoise::Exchange(StateNumbers& state) {
  state.Count(count_, 0, kBefore);
  for (int i = 0; i < count_; ++i) {
    for (auto& foot : before_[i]) {
      for (Eigen::Vector3d& point : foot) state.Vector(point);
    }
  }
  state.Number(variance_);
  if (variance_ < 0) state.Refuse("the variance of noise is below 0");
}

}  // namespace gelenk
