#include "gelenk/math/euler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace gelenk {
namespace {

constexpr double kPi = std::numbers::pi;

// A few roundings of half angles near 1.
constexpr double kExact = 1e-14;

std::vector<EulerAxes> AllOrders() {
  std::vector<EulerAxes> orders;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        if (ReachesEveryRotation({i, j, k})) orders.push_back({i, j, k});
      }
    }
  }
  return orders;
}

// Between rotations; an arc cosine would lose half of the digits.
double Distance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return 2 * std::min((a.coeffs() - b.coeffs()).norm(),
                      (a.coeffs() + b.coeffs()).norm());
}

class AngleSource {
 public:
  Eigen::Vector3d Next(double largest) {
    std::uniform_real_distribution<> angle(-largest, largest);
    return {angle(random_), angle(random_), angle(random_)};
  }

 private:
  std::mt19937 random_{11};
};

TEST(EulerTest, ThereAreTwelveOrders) { EXPECT_EQ(AllOrders().size(), 12); }

TEST(EulerTest, TurnsAboutMovingAxes) {
  AngleSource angles;
  for (const EulerAxes& axes : AllOrders()) {
    const Eigen::Vector3d a = angles.Next(10);
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) {
      matrix *=
          Eigen::AngleAxisd(a[i], Eigen::Vector3d::Unit(axes[i])).matrix();
    }
    EXPECT_TRUE(RotationFromEuler(axes, a).matrix().isApprox(matrix, 1e-14));
  }
}

TEST(EulerTest, AnglesMakeTheRotationTheyCameFrom) {
  AngleSource angles;
  for (const EulerAxes& axes : AllOrders()) {
    for (int round = 0; round < 1000; ++round) {
      const Eigen::Quaterniond q = RotationFromEuler(axes, angles.Next(20));
      const Eigen::Vector3d back = EulerFromRotation(axes, q, angles.Next(20));
      EXPECT_LT(Distance(RotationFromEuler(axes, back), q), 10 * kExact);
    }
  }
}

TEST(EulerTest, NearTheAnglesItFindsThem) {
  AngleSource angles;
  for (const EulerAxes& axes : AllOrders()) {
    for (int round = 0; round < 1000; ++round) {
      const Eigen::Vector3d a = angles.Next(20);
      const double middle =
          axes[0] == axes[2] ? std::sin(a[1]) : std::cos(a[1]);
      // Near gimbal lock another branch may be nearer.
      if (std::abs(middle) < 0.2) continue;
      const Eigen::Vector3d near = a + angles.Next(0.05);
      const Eigen::Vector3d back =
          EulerFromRotation(axes, RotationFromEuler(axes, a), near);
      EXPECT_LT((back - a).norm(), 1e-12);
    }
  }
}

TEST(EulerTest, StaysWithinHalfATurnOfTheNearAngles) {
  AngleSource angles;
  for (const EulerAxes& axes : AllOrders()) {
    for (int round = 0; round < 1000; ++round) {
      const Eigen::Vector3d near = angles.Next(20);
      const Eigen::Vector3d a = EulerFromRotation(
          axes, RotationFromEuler(axes, angles.Next(20)), near);
      EXPECT_LE((a - near).cwiseAbs().maxCoeff(), kPi + kExact * 20);
    }
  }
}

TEST(EulerTest, IsExactUpToAndInGimbalLock) {
  AngleSource angles;
  for (const EulerAxes& axes : AllOrders()) {
    const double lock = axes[0] == axes[2] ? 0 : kPi / 2;
    for (double off : {0.0, 1e-17, 1e-15, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9,
                       1e-8, 1e-6, 1e-4, 1e-2}) {
      for (double middle : {lock + off, lock - off, lock + kPi + off,
                            -lock + off, lock - kPi - off}) {
        Eigen::Vector3d a = angles.Next(6);
        a[1] = middle;
        const Eigen::Quaterniond q = RotationFromEuler(axes, a);
        const Eigen::Vector3d back = EulerFromRotation(axes, q, angles.Next(6));
        // Where an angle is given up, up to four times the lock's width.
        EXPECT_LT(Distance(RotationFromEuler(axes, back), q), 1e-10);
      }
    }
  }
}

TEST(EulerTest, KeepsTheFirstAngleInGimbalLock) {
  for (const EulerAxes& axes : AllOrders()) {
    const double lock = axes[0] == axes[2] ? 0 : kPi / 2;
    const Eigen::Quaterniond q = RotationFromEuler(axes, {0.3, lock, 0.4});
    const Eigen::Vector3d near(0.9, lock + 0.01, -0.1);
    const Eigen::Vector3d back = EulerFromRotation(axes, q, near);
    EXPECT_EQ(back[0], 0.9);
    EXPECT_NEAR(back[1], lock, 1e-12);
    EXPECT_LT(Distance(RotationFromEuler(axes, back), q), kExact * 10);
  }
}

TEST(EulerTest, FollowsManyTurnsWithoutAJump) {
  for (const EulerAxes& axes : AllOrders()) {
    Eigen::Vector3d at(0.1, 0.7, -0.2);
    for (int step = 0; step < 3000; ++step) {
      const double time = step * 0.01;
      // Two angles run on; the middle one stays off gimbal lock.
      const Eigen::Vector3d next(0.1 + time, 0.7 + 0.4 * std::sin(time),
                                 -0.2 - 2 * time);
      at = EulerFromRotation(axes, RotationFromEuler(axes, next), at);
      ASSERT_LT((at - next).norm(), 1e-10) << step;
    }
  }
}

}  // namespace
}  // namespace gelenk
