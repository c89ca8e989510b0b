// The inner loop of LevenbergMarquardtSolver, compiled once per level of the
// instruction set: GELENK_KERNEL_LEVEL names the level, GELENK_KERNEL_LANES is
// its vector width in doubles.
//
// Only plain arrays and functions of these kernels (and of rotation_bounds.h
// and goal_rows.h, out of line): an inline function of a library that was
// emitted here with a higher level could be picked by the linker for everybody.
#include "gelenk/base/kernel/scalar.h"
#include "gelenk/ik/kernel/descent.h"
#include "gelenk/ik/kernel/tree_active_set.h"
#include "gelenk/ik/kernel/tree_forward.h"
#include "gelenk/ik/kernel/tree_jacobian.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_normal_system.h"
#include "gelenk/ik/kernel/tree_posture.h"
#include "gelenk/ik/kernel/tree_residual.h"
#include "gelenk/ik/kernel/tree_state.h"
#include "gelenk/ik/kernel/tree_step.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr double kDampingPerEnergy = 1e-2;

// The model that Descend takes steps of.
class Solver {
 public:
  explicit Solver(const TreeState& state) : state_(state) {}

  double Evaluate() {
    ForwardPass(state_);
    posture_energy_ = kernel::GELENK_KERNEL_LEVEL::PostureEnergy(state_);
    return Residuals(state_) + posture_energy_;
  }

  double PostureEnergy() const { return posture_energy_; }
  double LastMove() const { return last_move_; }
  bool IsWithinTolerance() const {
    return kernel::GELENK_KERNEL_LEVEL::IsWithinTolerance(state_);
  }

  void KeepBest() {
    Copy(state_.q, state_.work.best_positions, state_.tree.position_count);
  }
  void TakeBest() {
    Copy(state_.work.best_positions, state_.q, state_.tree.position_count);
  }

  bool Linearize() {
    LinearizeGoals(state_);
    LinearizePosture(state_);
    return BlockColumns(state_);
  }

  void Step(double damping) {
    AccumulateGoals(state_);
    AccumulatePosture(state_);
    Factorize(state_, damping);
    Solve(state_);
    last_move_ = Move(state_);
  }

 private:
  const TreeState state_;
  double posture_energy_ = 0;
  double last_move_ = 0;
};

}  // namespace

Attempt Run(const TreeLayout& tree, const TaskTarget* targets,
            const Settings& settings, const Workspace& workspace,
            double* positions) {
  Solver solver({tree, targets, settings, workspace, positions});
  return Descend(solver, settings, kDampingPerEnergy);
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
