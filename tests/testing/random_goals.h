// Goals of every kind at random, for properties that must hold for all.
#ifndef GELENK_TESTS_TESTING_RANDOM_GOALS_H_
#define GELENK_TESTS_TESTING_RANDOM_GOALS_H_

#include <Eigen/Core>
#include <optional>

#include "gelenk/ik/goal.h"
#include "gelenk/skeleton/skeleton.h"
#include "tests/testing/random.h"

namespace gelenk::testing {

// Numbers for the kinds that rows can be asked of; masks at random.
inline constexpr int kPositionGoal = 0;
inline constexpr int kRotationGoal = 1;
inline constexpr int kPoseGoal = 2;
inline constexpr int kAimGoal = 3;
inline constexpr int kPoleGoal = 4;
inline constexpr int kRelativeGoal = 5;
inline constexpr int kCenterOfMassGoal = 6;
inline constexpr int kHalfSpaceGoal = 7;
inline constexpr int kGoalKindCount = 8;

// A goal of that kind on joints or end effectors of `skeleton`, met at
// `truth` with the skeleton at the origin; nothing when the skeleton has no
// limb for a pole.
std::optional<GoalKind> RandomGoal(Random& random, const Skeleton& skeleton,
                                   int kind, const Eigen::VectorXd& truth);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_RANDOM_GOALS_H_
