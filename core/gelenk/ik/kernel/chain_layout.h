// The data of a serial chain with one position goal, flat and plain like
// tree_layout.h, for the kernel that takes a step in O(n).
//
// With n columns and 3 rows the Levenberg-Marquardt step is cheap in the small
// space: dq = S^-1 J^T (J S^-1 J^T + lambda)^-1 e, the same step as by the n x
// n normal matrix. What is left is forward kinematics, which a chain makes
// sequential. So the chain is cut into kChainLanes *segments*, each worked on
// in a frame of its own by one lane of vector registers, and joined by one
// product of frames a segment:
//   step 0: the first node of every segment, step 1: the second, ...
// The nodes of a step are of one type; lanes that have no such node idle with a
// node that does nothing.
#ifndef GELENK_IK_KERNEL_CHAIN_LAYOUT_H_
#define GELENK_IK_KERNEL_CHAIN_LAYOUT_H_

#include <cstdint>

#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel {

// Lanes of the widest level; narrower ones take them in several parts.
inline constexpr int kChainLanes = 8;
using LaneNumbers = double[kChainLanes];

struct alignas(64) ChainStep {
  LaneNumbers rotation[9];     // parent_from_rest, row-major
  LaneNumbers translation[3];  // m
  LaneNumbers compliance[3];   // 1 / stiffness of each column, 0 in idle lanes
  int node[kChainLanes];       // -1 in idle lanes
  int column[kChainLanes];     // first
  int position[kChainLanes];   // first number in q
  bool limited[kChainLanes];   // has a swing cone or twist range
  int record;                  // where its working memory starts
  NodeType type;               // kRevolute, kPrismatic or kSpherical
  bool offset_is_translation;  // no rest rotation in any lane
  bool limits_rotation;        // some lane is limited
};

// Working memory of a step: so many LaneNumbers, by the type of the nodes.
inline constexpr int kScalarRecord = 12;
inline constexpr int kSphericalRecord = 35;

struct ChainLayout {
  const ChainStep* steps;
  const RotationLimit* rotation_limits;  // per node
  int step_count;
  int lane_count;   // with nodes; the first ones
  int record_size;  // LaneNumbers of all steps
  Vector3 last_from_tip;
};

// Sized by the caller, 64-byte aligned.
struct ChainWorkspace {
  double* records;          // kChainLanes * record_size
  uint8_t* touched;         // per node, flags of RotationTouch; out
  double* position_error2;  // out
};

// Improves `positions` in place; see LevenbergMarquardtSolver.
using ChainFunction = Attempt (*)(const ChainLayout& chain,
                                  const TaskTarget& target,
                                  const Settings& settings,
                                  const ChainWorkspace& workspace,
                                  double* positions);

namespace baseline {
Attempt RunChain(const ChainLayout&, const TaskTarget&, const Settings&,
                 const ChainWorkspace&, double*);
}
namespace avx2 {
Attempt RunChain(const ChainLayout&, const TaskTarget&, const Settings&,
                 const ChainWorkspace&, double*);
}
namespace avx512 {
Attempt RunChain(const ChainLayout&, const TaskTarget&, const Settings&,
                 const ChainWorkspace&, double*);
}

}  // namespace gelenk::kernel

#endif  // GELENK_IK_KERNEL_CHAIN_LAYOUT_H_
