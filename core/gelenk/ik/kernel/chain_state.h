// One attempt on a chain: what it is asked, the records of its steps, and where
// it is. The pieces of the kernel of chains are functions of it; each works on
// all lanes, kWidth of them at a time.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_STATE_H_
#define GELENK_IK_KERNEL_CHAIN_STATE_H_

#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr int kWidth = GELENK_KERNEL_LANES;
static_assert(kChainLanes % kWidth == 0);
using Vector = Lanes<kWidth>;
using Pack = Vector::Pack;
using Mask = Vector::Mask;

// Places in the record of a step.
enum ScalarPlace {
  kAngle,
  kLower,
  kUpper,
  kBestAngle,
  kWeight,
  kChange,
  kAxis,  // 3; of its Jacobian once that is known
  kOrigin = kAxis + 3,
  kScalarEnd = kOrigin + 3,
};
static_assert(kScalarEnd == kScalarRecord);
enum SphericalPlace {
  kQuaternion,
  kBestQuaternion = kQuaternion + 4,
  kWeights = kBestQuaternion + 4,
  kChanges = kWeights + 3,
  kAxes = kChanges + 3,
  kCenter = kAxes + 9,
  kBasis = kCenter + 3,
  kSphericalEnd = kBasis + 9,
};
static_assert(kSphericalEnd == kSphericalRecord);

// The numbers of some lanes, `part` on.
GELENK_INLINE Pack Get(const LaneNumbers* numbers, int place, int part) {
  return Vector::Load(numbers[place] + part);
}
GELENK_INLINE void Put(LaneNumbers* numbers, int place, int part,
                       const Pack& pack) {
  Vector::Store(pack, numbers[place] + part);
}

struct ChainState {
  GELENK_INLINE ChainState(const ChainLayout& layout, const TaskTarget& goal,
                           const Settings& solve_settings,
                           const ChainWorkspace& workspace, double* positions)
      : chain(layout),
        target(goal),
        settings(solve_settings),
        work(workspace),
        q(positions),
        part_end((layout.lane_count + kWidth - 1) / kWidth * kWidth) {}

  const ChainLayout& chain;
  const TaskTarget& target;
  const Settings& settings;
  const ChainWorkspace& work;
  double* const q;
  const int part_end;
  // By segments.
  alignas(64) LaneNumbers segment_rotation[9];  // its end in its own frame
  alignas(64) LaneNumbers segment_end[3];
  alignas(64) LaneNumbers base_rotation[9] = {};  // its own frame in the world
  alignas(64) LaneNumbers base[3] = {};
  double tip[3];
  double error[3];   // weighted
  double normal[6];  // J S^-1 J^T, upper triangle, unweighted

  LaneNumbers* RecordOf(const ChainStep& step) const {
    return reinterpret_cast<LaneNumbers*>(work.records) + step.record;
  }
};

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_STATE_H_
