// Well-known mechanisms, for tests that need a particular one.
#ifndef GELENK_TESTS_TESTING_EXAMPLE_SKELETONS_H_
#define GELENK_TESTS_TESTING_EXAMPLE_SKELETONS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

// Revolute joints "j0", "j1", .. about Z in a row along X, the first at `base`;
// the end of the last link is "tip". Angles are free.
std::shared_ptr<const Skeleton> PlanarChain(
    const Eigen::Vector3d& base, const std::vector<double>& link_lengths_m);

// The Franka Emika Panda: seven revolute joints "j0" .. "j6" about Z with their
// limits, the flange is "tip".
std::shared_ptr<const Skeleton> PandaArm();

// Universal Robots' UR5: six revolute joints "j0" .. "j5" of two turns either
// way, singular wherever elbow or wrist are straight; the flange is "tip".
std::shared_ptr<const Skeleton> Ur5Arm();

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_EXAMPLE_SKELETONS_H_
