// A body as robots have it.
#ifndef GELENK_TESTS_TESTING_ROBOT_OF_HINGES_H_
#define GELENK_TESTS_TESTING_ROBOT_OF_HINGES_H_

#include <memory>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

// The humanoid with three revolute joints for each ball, on a fixed base.
std::shared_ptr<const Skeleton> RobotOfHinges();

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_ROBOT_OF_HINGES_H_
