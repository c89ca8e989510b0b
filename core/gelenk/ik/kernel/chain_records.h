// How coordinates come into the records of a chain's steps, are remembered
// there, and go back.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_RECORDS_H_
#define GELENK_IK_KERNEL_CHAIN_RECORDS_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_limits.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

// From q to the records. Lanes without a node get a number that moves
// nothing.
inline void Load(const ChainState& state) {
  for (int s = 0; s < state.chain.step_count; ++s) {
    const ChainStep& step = state.chain.steps[s];
    LaneNumbers* record = state.RecordOf(step);
    const bool spherical = step.type == NodeType::kSpherical;
    for (int part = 0; part < state.part_end; part += kWidth) {
      const Mask used = Get(step.compliance, 0, part) > 0;
      if (spherical) {
        for (int k = 0; k < 4; ++k) {
          const Pack q = Vector::Gather(state.q + k, step.position + part);
          const Pack still = Vector::All(k == 3);
          Put(record, kQuaternion + k, part, used ? q : still);
        }
        continue;
      }
      const Pack q = Vector::Gather(state.q, step.position + part);
      const Pack still = {};
      const Pack unbounded = Vector::All(__builtin_inf());
      const int* columns = step.column + part;
      const Pack lower = Vector::Gather(state.settings.lower, columns);
      const Pack upper = Vector::Gather(state.settings.upper, columns);
      Put(record, kAngle, part, used ? q : still);
      Put(record, kLower, part, used ? lower : -unbounded);
      Put(record, kUpper, part, used ? upper : unbounded);
    }
    if (step.limits_rotation) {
      TouchLimits(state, step, record);
    } else if (spherical) {
      for (int node : step.node) {
        if (node >= 0) state.work.touched[node] = 0;
      }
    }
  }
}

// From the records to q.
inline void Save(const ChainState& state) {
  for (int s = 0; s < state.chain.step_count; ++s) {
    const ChainStep& step = state.chain.steps[s];
    const LaneNumbers* record = state.RecordOf(step);
    const int numbers = step.type == NodeType::kSpherical ? 4 : 1;
    for (int lane = 0; lane < kChainLanes; ++lane) {
      if (step.node[lane] < 0) continue;
      double* q = state.q + step.position[lane];
      for (int k = 0; k < numbers; ++k) q[k] = record[k][lane];
    }
  }
}

template <typename Visit>
GELENK_INLINE void ForEachNumber(const ChainState& state, Visit visit) {
  for (int s = 0; s < state.chain.step_count; ++s) {
    LaneNumbers* record = state.RecordOf(state.chain.steps[s]);
    const bool spherical = state.chain.steps[s].type == NodeType::kSpherical;
    for (int part = 0; part < state.part_end; part += kWidth) {
      if (!spherical) {
        visit(record, kAngle, kBestAngle, part);
        continue;
      }
      for (int k = 0; k < 4; ++k) {
        visit(record, kQuaternion + k, kBestQuaternion + k, part);
      }
    }
  }
}

inline void KeepBest(const ChainState& state) {
  ForEachNumber(state, [](LaneNumbers* record, int q, int best, int part) {
    Put(record, best, part, Get(record, q, part));
  });
}

inline void TakeBest(const ChainState& state) {
  ForEachNumber(state, [](LaneNumbers* record, int q, int best, int part) {
    Put(record, q, part, Get(record, best, part));
  });
  for (int s = 0; s < state.chain.step_count; ++s) {
    const ChainStep& step = state.chain.steps[s];
    if (step.limits_rotation) TouchLimits(state, step, state.RecordOf(step));
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_RECORDS_H_
