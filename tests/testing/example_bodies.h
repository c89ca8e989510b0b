// Bodies of people as motion capture and games have them.
#ifndef GELENK_TESTS_TESTING_EXAMPLE_BODIES_H_
#define GELENK_TESTS_TESTING_EXAMPLE_BODIES_H_

#include <memory>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

// 64 joints: free "hips", all others spherical with swing cone and twist range.
// Spine, head with eyes and jaw, two arms with fingers, two legs; about 1.7 m.
// End effectors: "left_palm", "right_palm", "left_sole", "right_sole", "crown",
// "chest".
std::shared_ptr<const Skeleton> PersonWithFingers();

// 64 spherical joints in six chains from one root, each chain with an end
// effector "tip0" .. "tip5": every joint moves one of them.
std::shared_ptr<const Skeleton> SixTentacles();

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_EXAMPLE_BODIES_H_
