// Bounds of one solve that are narrower than the joints' limits, in the form
// that the solver's kernels take them.
#ifndef GELENK_IK_COLUMN_BOUNDS_H_
#define GELENK_IK_COLUMN_BOUNDS_H_

#include <optional>
#include <vector>

#include "gelenk/ik/ik_problem.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/step_bounds.h"
#include "gelenk/skeleton/pose.h"

namespace gelenk {

// Owns the arrays behind kernel::Settings; reused from solve to solve, and
// allocates only for a larger problem than before.
class ColumnBounds {
 public:
  // Narrows `settings`, which hold the limits, to moves of at most `max_step`
  // (none when unset) and within `bounds` (none when null) from `start`, which
  // is inside the limits. The arrays are valid until the next call.
  void Narrow(const IkProblem& problem, const kernel::TreeLayout& tree,
              std::optional<double> max_step, const StepBounds* bounds,
              const ConstVectorView& start, kernel::Settings& settings);

 private:
  struct Interval {
    double lower;
    double upper;
  };

  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<double> start_;
  std::vector<double> turn_cosine_;
  std::vector<double> turn_sine_;
};

}  // namespace gelenk

#endif  // GELENK_IK_COLUMN_BOUNDS_H_
