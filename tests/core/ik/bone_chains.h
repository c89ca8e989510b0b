// Chains of bones, for the tests of solvers that work on them.
#ifndef GELENK_TESTS_CORE_IK_BONE_CHAINS_H_
#define GELENK_TESTS_CORE_IK_BONE_CHAINS_H_

#include <memory>

#include "gelenk/skeleton/joint_limits.h"
#include "gelenk/skeleton/skeleton.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

enum class BoneJoints {
  kHinges,     // one revolute joint a bone, all axes parallel, either way round
  kSpherical,  // one spherical joint a bone
  kGimbals,    // three revolute joints a bone, skew but each perpendicular to
               // the next
};

// `bone_count` bones of random length, 0.02 to 0.2 m, at random rests, the
// first pivot away from the origin; the last bone ends at "tip". Joints are
// "j0", "j1", .. Revolute joints have the limits given.
std::shared_ptr<const Skeleton> RandomBones(Random& random, BoneJoints joints,
                                            int bone_count,
                                            const JointLimits& limits = {});

// `bone_count` bones of equal length, 1 m together, one joint each, straight
// along X.
std::shared_ptr<const Skeleton> EqualBones(int bone_count, BoneJoints joints,
                                           const JointLimits& limits = {});

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_CORE_IK_BONE_CHAINS_H_
