#include "tests/benchmarks/ik/kdl_peer.h"

#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <memory>
#include <vector>

namespace gelenk::benchmarks {
namespace {

constexpr int kIterations = 100;
// Where a joint has no limit.
constexpr double kFar = 1e9;

KDL::Frame FrameOf(const RigidTransform& transform) {
  const Eigen::Quaterniond& r = transform.rotation;
  const Eigen::Vector3d& t = transform.translation;
  return {KDL::Rotation::Quaternion(r.x(), r.y(), r.z(), r.w()),
          KDL::Vector(t.x(), t.y(), t.z())};
}

KDL::Joint JointOf(const Joint& joint) {
  const KDL::Vector axis(joint.axis.x(), joint.axis.y(), joint.axis.z());
  switch (joint.type) {
    case JointType::kRevolute:
      return KDL::Joint(KDL::Vector::Zero(), axis, KDL::Joint::RotAxis);
    case JointType::kPrismatic:
      return KDL::Joint(KDL::Vector::Zero(), axis, KDL::Joint::TransAxis);
    default:
      return KDL::Joint(KDL::Joint::None);
  }
}

// Solvers hold references to the chain, so that they live together.
struct Arm {
  explicit Arm(const cli::IkSet& set) : set(set) {
    const Skeleton& skeleton = *set.skeleton;
    const EffectorFrame tip =
        *skeleton.FindEffector(EffectorId(set.goals[0].kind));
    std::vector<int> path;
    for (int j = tip.joint; j >= 0; j = skeleton.span(j).parent) {
      path.push_back(j);
    }
    std::reverse(path.begin(), path.end());
    // A segment is a joint and the way to the next one.
    chain.addSegment(
        KDL::Segment(KDL::Joint(KDL::Joint::None),
                     FrameOf(skeleton.joint(path[0]).parent_from_joint)));
    for (size_t i = 0; i < path.size(); ++i) {
      const RigidTransform& next =
          i + 1 < path.size() ? skeleton.joint(path[i + 1]).parent_from_joint
                              : tip.joint_from_effector;
      chain.addSegment(
          KDL::Segment(JointOf(skeleton.joint(path[i])), FrameOf(next)));
    }
    const size_t count = set.coordinates.size();
    lower.resize(count);
    upper.resize(count);
    start.resize(count);
    answer.resize(count);
    for (size_t i = 0; i < count; ++i) {
      const PositionBounds& bounds = skeleton.position_bounds();
      lower(i) = std::max(-kFar, bounds.lower[set.coordinates[i]]);
      upper(i) = std::min(kFar, bounds.upper[set.coordinates[i]]);
    }
  }

  template <class Solver>
  void Solve(Solver& solver, int problem,
             Eigen::Ref<Eigen::VectorXd> positions) {
    for (size_t i = 0; i < set.coordinates.size(); ++i) {
      start(i) = positions[set.coordinates[i]];
    }
    solver.CartToJnt(start, FrameOf(set.target(problem, 0)), answer);
    for (size_t i = 0; i < set.coordinates.size(); ++i) {
      positions[set.coordinates[i]] = answer(i);
    }
  }

  const cli::IkSet& set;
  KDL::Chain chain;
  KDL::JntArray lower;
  KDL::JntArray upper;
  KDL::JntArray start;
  KDL::JntArray answer;
};

struct NewtonArm : Arm {
  NewtonArm(const cli::IkSet& set, double tolerance)
      : Arm(set),
        forward(chain),
        velocity(chain),
        solver(chain, lower, upper, forward, velocity, kIterations, tolerance) {
  }
  KDL::ChainFkSolverPos_recursive forward;
  KDL::ChainIkSolverVel_pinv velocity;
  KDL::ChainIkSolverPos_NR_JL solver;
};

struct MarquardtArm : Arm {
  MarquardtArm(const cli::IkSet& set, double tolerance)
      : Arm(set),
        solver(chain, Eigen::Matrix<double, 6, 1>::Ones(), tolerance) {}
  KDL::ChainIkSolverPos_LMA solver;
};

template <class AnyArm>
cli::SolveProblem DoorTo(const cli::IkSet& set, double tolerance) {
  auto arm = std::make_shared<AnyArm>(set, tolerance);
  return [arm](int problem, Eigen::Ref<Eigen::VectorXd> positions) {
    arm->Solve(arm->solver, problem, positions);
  };
}

}  // namespace

cli::SolveProblem KdlNewtonWithLimits(const cli::IkSet& set, double tolerance) {
  return DoorTo<NewtonArm>(set, tolerance);
}

cli::SolveProblem KdlLevenbergMarquardt(const cli::IkSet& set,
                                        double tolerance) {
  return DoorTo<MarquardtArm>(set, tolerance);
}

}  // namespace gelenk::benchmarks
