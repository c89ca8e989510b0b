#include "server/session/joint_motion.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <optional>

#include "gelenk/skeleton/pose.h"
#include "tests/testing/example_skeletons.h"

namespace gelenk::server {
namespace {

class JointMotionTest : public ::testing::Test {
 protected:
  const std::shared_ptr<const Skeleton> skeleton_ = testing::PandaArm();
  const Eigen::VectorXd rest_ = NeutralPositions(*skeleton_);
};

TEST_F(JointMotionTest, VelocityIsTheDifferenceOverTheTime) {
  Eigen::VectorXd velocity =
      Eigen::VectorXd::Constant(skeleton_->velocity_count(), 0.2);
  Eigen::VectorXd moved = rest_;
  Integrate(*skeleton_, rest_, 0.1 * velocity, moved);

  JointMotion motion;
  NoteMotion(*skeleton_, absl::Seconds(1), rest_, rest_, motion);
  EXPECT_EQ(motion.velocity,
            Eigen::VectorXd::Zero(skeleton_->velocity_count()));
  NoteMotion(*skeleton_, absl::Milliseconds(1100), rest_, moved, motion);
  EXPECT_LT((motion.velocity - velocity).norm(), 1e-9);
}

TEST_F(JointMotionTest, WithoutTimesNothingIsBoundedAndNothingMoves) {
  JointMotion motion;
  StepBounds bounds;
  EXPECT_FALSE(BoundSpeed(*skeleton_, motion, absl::Seconds(1), bounds));
  NoteMotion(*skeleton_, absl::Seconds(1), rest_, rest_, motion);
  EXPECT_FALSE(BoundSpeed(*skeleton_, motion, std::nullopt, bounds));
  EXPECT_TRUE(BoundSpeed(*skeleton_, motion, absl::Seconds(2), bounds));
}

TEST_F(JointMotionTest, BroughtVelocityHasTheSkeletonsSizeAndIsFinite) {
  JointMotion motion;
  motion.velocity.setZero(1);
  Violations untimed;
  CheckMotion(*skeleton_, motion, untimed);
  EXPECT_TRUE(untimed.empty());

  motion.capture_time = absl::Seconds(1);
  Violations small;
  CheckMotion(*skeleton_, motion, small);
  EXPECT_FALSE(small.empty());

  motion.velocity.setZero(skeleton_->velocity_count());
  motion.velocity[0] = std::numeric_limits<double>::quiet_NaN();
  Violations unfinite;
  CheckMotion(*skeleton_, motion, unfinite);
  EXPECT_FALSE(unfinite.empty());
}

}  // namespace
}  // namespace gelenk::server
