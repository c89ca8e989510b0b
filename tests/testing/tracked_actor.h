// A person who walks and is tracked.
#ifndef GELENK_TESTS_TESTING_TRACKED_ACTOR_H_
#define GELENK_TESTS_TESTING_TRACKED_ACTOR_H_

#include <Eigen/Core>
#include <memory>

#include "gelenk/retarget/body_model.h"
#include "gelenk/retarget/tracker_body.h"

namespace gelenk::testing {

// What trackers in the joints of a body see: head and hands, `with_lower` also
// waist and feet.
TrackerFrame TrackersOn(const BodyModel& model,
                        const Eigen::VectorXd& positions, bool with_lower);

// The walk of WalkingBvh on the humanoid, a column a frame.
struct Actor {
  std::shared_ptr<const BodyModel> model;
  Eigen::MatrixXd positions;
};
Actor WalkingActor(int frames);

}  // namespace gelenk::testing

#endif  // GELENK_TESTS_TESTING_TRACKED_ACTOR_H_
