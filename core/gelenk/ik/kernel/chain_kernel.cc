// The inner loop of LevenbergMarquardtSolver for serial chains with one
// position goal (see chain_layout.h), compiled once per level of the
// instruction set: GELENK_KERNEL_LEVEL names the level, GELENK_KERNEL_LANES is
// its vector width in doubles.
#include "gelenk/ik/kernel/chain_forward.h"
#include "gelenk/ik/kernel/chain_jacobian.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_records.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/chain_step.h"
#include "gelenk/ik/kernel/descent.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// With as much damping a straight chain bends at all its joints rather than
// throws some of them round; ten times less takes more iterations and restarts.
constexpr double kDampingPerEnergy = 1e-1;

// The model that Descend takes steps of.
class ChainSolver {
 public:
  ChainSolver(const ChainLayout& chain, const TaskTarget& target,
              const Settings& settings, const ChainWorkspace& workspace,
              double* positions)
      : state_(chain, target, settings, workspace, positions) {}

  Attempt Run() {
    Load(state_);
    Attempt attempt = {AttemptEnd::kConverged, 0, 0, false};
    *state_.work.position_error2 = 0;
    if (state_.target.active) {
      attempt = Descend(*this, state_.settings, kDampingPerEnergy);
    }
    Save(state_);
    return attempt;
  }

  // Where everything is; returns half the weighted squared error.
  double Evaluate() {
    if (!MoveSegments<false>(state_)) MoveSegments<true>(state_);
    return JoinSegments(state_);
  }

  // Chains with a posture go to the tree's kernel.
  double PostureEnergy() const { return 0; }
  double LastMove() const { return 0; }

  bool IsWithinTolerance() const {
    // So written that NaN is not within.
    return *state_.work.position_error2 <= state_.settings.position_tolerance2;
  }

  void KeepBest() { kernel::GELENK_KERNEL_LEVEL::KeepBest(state_); }
  void TakeBest() { kernel::GELENK_KERNEL_LEVEL::TakeBest(state_); }
  bool Linearize() { return kernel::GELENK_KERNEL_LEVEL::Linearize(state_); }
  void Step(double damping) {
    kernel::GELENK_KERNEL_LEVEL::Step(state_, damping);
  }

 private:
  ChainState state_;
};

}  // namespace

Attempt RunChain(const ChainLayout& chain, const TaskTarget& target,
                 const Settings& settings, const ChainWorkspace& workspace,
                 double* positions) {
  return ChainSolver(chain, target, settings, workspace, positions).Run();
}

}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL
