// A small recorded walk, made up: the text of a BVH file.
#ifndef GELENK_TESTS_TESTING_WALKING_BVH_H_
#define GELENK_TESTS_TESTING_WALKING_BVH_H_

#include <string>

namespace gelenk::testing {

// 17 joints in cm, about 1.7 m tall, up +Y, facing +Z, 50 frames a second: Hips
// walk along +Z, arms and legs swing against each other, knees and elbows bend.
// The first frame is part of the motion.
std::string WalkingBvh(int frame_count);

// The same behind a frame that is none of it: its arms stretched out to a T.
std::string WalkingBvhBehindATPose(int frame_count);

inline constexpr int kWalkingJointCount = 17;
inline constexpr int kWalkingEndSiteCount = 5;

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_WALKING_BVH_H_
