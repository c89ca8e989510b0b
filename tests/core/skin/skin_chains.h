// Chains of links and the skins on them, for the tests of layered skins.
#ifndef GELENK_TESTS_CORE_SKIN_SKIN_CHAINS_H_
#define GELENK_TESTS_CORE_SKIN_SKIN_CHAINS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skin/volume_rig.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

// Spherical joints "j0", "j1", .. each with its link along X; the end of the
// last is "tip". At rest each is turned against the one before by at most
// `rest_bend_rad` about any axis.
std::shared_ptr<const Skeleton> BallChain(Random& random,
                                          const std::vector<double>& lengths_m,
                                          double rest_bend_rad = 0);

// Lengths in [0.3, 2) m.
std::vector<double> RandomLengths(Random& random, int count);

// All joints of a BallChain turned by at most `bend_rad` about any axis.
Eigen::VectorXd BentPose(Random& random, const Skeleton& skeleton,
                         double bend_rad);

// Explicit muscles, one a link: scales in [0.6, 1.8), pivots in
// [-0.2, 0.2) m.
SkinMuscles RandomMuscles(Random& random, const Skeleton& skeleton);

// Two links of 1 m along X, "upper" and "lower"; the elbow turns about `axis`
// (positions: the root's quaternion, then the angle).
std::shared_ptr<const Skeleton> TwoLinkArm(const Eigen::Vector3d& axis);
// Its rest pose with the elbow turned.
Eigen::VectorXd ElbowAt(const Skeleton& arm, double angle_rad);

// A pelvis ("pelvis", link along X to "spine") and a leg ("thigh", then
// "shank") that hangs from the middle of it, turned by a right angle; all ball
// joints.
std::shared_ptr<const Skeleton> PelvisWithLeg();

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_SKIN_SKIN_CHAINS_H_
