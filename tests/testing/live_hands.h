// Arms that follow a live hand: where they start, and how it goes past their
// reach.
#ifndef GELENK_TESTS_TESTING_LIVE_HANDS_H_
#define GELENK_TESTS_TESTING_LIVE_HANDS_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "gelenk/skeleton/skeleton.h"

namespace gelenk::testing {

struct Hand {
  std::string name;
  std::shared_ptr<const Skeleton> skeleton;
  Eigen::VectorXd start;

  // The end effector that follows.
  std::string tip() const { return skeleton->end_effectors()[0].id; }
};

// A Panda, a UR5, and a human arm: ball joints at shoulder and wrist, a hinge
// for an elbow.
std::vector<Hand> LiveHands();

// The hand's way straight out, past the boundary of the reach: from where it
// starts, along a unit vector away from the second joint.
struct WayOut {
  Eigen::Vector3d from;
  Eigen::Vector3d direction;
};
WayOut WayOutOf(const Hand& hand);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_LIVE_HANDS_H_
