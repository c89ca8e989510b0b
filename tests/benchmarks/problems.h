// The problems that the benchmarks solve: made in code, the same everywhere.
#ifndef GELENK_TESTS_BENCHMARKS_PROBLEMS_H_
#define GELENK_TESTS_BENCHMARKS_PROBLEMS_H_

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "gelenk/ik/goal.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk::benchmarks {

// A skeleton, goals on it, and a motion whose targets a stream would send.
struct StreamProblem {
  std::shared_ptr<const Skeleton> skeleton;
  std::vector<Goal> goals;
  // Per frame, per goal.
  std::vector<std::vector<GoalTarget>> frames;
  // The pose that the motion starts from.
  Eigen::VectorXd start;
};

// The Franka Panda (7 revolute joints), one pose goal at its flange.
StreamProblem PandaProblem(int frame_count);

// A body of 31 ball joints with limits: hands, feet and head by position, hips
// by pose. It dances.
StreamProblem BodyProblem(int frame_count);

// The same body, feet planted by pose, hands by position, and a posture that
// holds the rest; the hands wave. With `priorities` at levels of their own in
// this order; without, all at one, the posture at a weight of 1e-4.
StreamProblem StandingProblem(int frame_count, bool priorities);

}  // namespace gelenk::benchmarks

#endif  // GELENK_TESTS_BENCHMARKS_PROBLEMS_H_
