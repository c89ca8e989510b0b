// What a body stands on: how high the ground is at every place.
//
// Canonical coordinates: m, Y up. Immutable, safe to use from any thread.
#ifndef GELENK_CONTACT_GROUND_H_
#define GELENK_CONTACT_GROUND_H_

#include <Eigen/Core>
#include <memory>

#include "absl/status/statusor.h"

namespace gelenk {

class Ground {
 public:
  virtual ~Ground() = default;
  // Allocates nothing.
  virtual double HeightAt(double x, double z) const = 0;

  double HeightAt(const Eigen::Vector3d& point) const {
    return HeightAt(point.x(), point.z());
  }
};

class FlatGround : public Ground {
 public:
  explicit FlatGround(double height_m = 0) : height_m_(height_m) {}
  using Ground::HeightAt;
  double HeightAt(double, double) const override { return height_m_; }

 private:
  double height_m_;
};

// Heights on a regular grid, bilinear between its nodes; beyond the grid those
// of its edge.
class HeightField : public Ground {
 public:
  // heights_m(i, k) stands at (origin_x + i * spacing, origin_z + k * spacing).
  // Errors: INVALID_ARGUMENT naming heights_m that are not finite or fewer than
  // 2 x 2, an origin that is not finite or a spacing that is not positive.
  static absl::StatusOr<std::unique_ptr<HeightField>> Create(
      Eigen::MatrixXd heights_m, double origin_x_m, double origin_z_m,
      double spacing_m);

  using Ground::HeightAt;
  double HeightAt(double x, double z) const override;

 private:
  HeightField(Eigen::MatrixXd heights_m, double origin_x_m, double origin_z_m,
              double spacing_m)
      : heights_m_(std::move(heights_m)),
        origin_x_m_(origin_x_m),
        origin_z_m_(origin_z_m),
        spacing_m_(spacing_m) {}

  Eigen::MatrixXd heights_m_;
  double origin_x_m_;
  double origin_z_m_;
  double spacing_m_;
};

}  // namespace gelenk

#endif  // GELENK_CONTACT_GROUND_H_
