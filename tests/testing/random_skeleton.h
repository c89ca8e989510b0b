// Random trees of joints, for properties that must hold on every skeleton.
#ifndef GELENK_TESTS_TESTING_RANDOM_SKELETON_H_
#define GELENK_TESTS_TESTING_RANDOM_SKELETON_H_

#include <memory>
#include <vector>

#include "gelenk/skeleton/skeleton.h"
#include "gelenk/skeleton/skeleton_builder.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

// What a random tree is made of; probabilities are per joint.
struct SkeletonRecipe {
  int joint_count = 12;
  // Drawn with equal chance.
  std::vector<JointType> types = {JointType::kFixed,     JointType::kRevolute,
                                  JointType::kPrismatic, JointType::kSpherical,
                                  JointType::kPlanar,    JointType::kFree};
  // That a joint hangs from any earlier joint, not from the last one.
  double branching = 0.3;
  // That a revolute or prismatic joint follows an earlier one.
  double mimicking = 0.2;
  // That a joint has limits: around the neutral pose for numbers, a swing cone
  // without or with a twist range for rotations.
  double limited = 0.6;
  // That a limited number is frozen: lower == upper.
  double frozen = 0.1;
  // Coordinates of a rest offset reach this far, m.
  double offset_m = 0.5;
};

// Joints "j0", "j1", .. with skew axes, parents first, not yet built; end
// effectors "e0", "e1", .. at the leaves.
SkeletonBuilder RandomSkeletonBuilder(Random& random,
                                      const SkeletonRecipe& recipe = {});
std::shared_ptr<const Skeleton> RandomSkeleton(
    Random& random, const SkeletonRecipe& recipe = {});

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RANDOM_SKELETON_H_
