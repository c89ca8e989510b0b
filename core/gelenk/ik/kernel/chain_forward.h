// Forward kinematics of a chain: each segment by itself, and the segments
// joined.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_CHAIN_FORWARD_H_
#define GELENK_IK_KERNEL_CHAIN_FORWARD_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/lanes.h"
#include "gelenk/ik/kernel/chain_layout.h"
#include "gelenk/ik/kernel/chain_state.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

constexpr int kRows = kWidth < 4 ? kWidth : 4;
using Rows = Lanes<kRows>::Pack;

// From the frame of the node before to that of this one at rest.
GELENK_INLINE void ToRest(const ChainStep& step, int part, Pack* rotation,
                          Pack* origin) {
  Pack offset[3];
  for (int k = 0; k < 3; ++k) offset[k] = Get(step.translation, k, part);
  AddTransformed(rotation, offset, origin);
  if (step.offset_is_translation) return;
  Pack rest[9], turned[9];
  for (int k = 0; k < 9; ++k) rest[k] = Get(step.rotation, k, part);
  Multiply(rotation, rest, turned);
  for (int k = 0; k < 9; ++k) rotation[k] = turned[k];
}

template <bool kAnyAngle>
GELENK_INLINE void TurnAboutZ(const Pack& angle, LaneNumbers* record, int part,
                              Pack* rotation, const Pack* origin) {
  Pack sine, cosine;
  if (kAnyAngle) {
    for (int lane = 0; lane < kWidth; ++lane) {
      sine[lane] = __builtin_sin(angle[lane]);
      cosine[lane] = __builtin_cos(angle[lane]);
    }
  } else {
    Vector::SineCosine(angle, &sine, &cosine);
  }
  for (int k = 0; k < 3; ++k) {
    Put(record, kAxis + k, part, rotation[3 * k + 2]);
    Put(record, kOrigin + k, part, origin[k]);
    const Pack x = rotation[3 * k], y = rotation[3 * k + 1];
    rotation[3 * k] = x * cosine + y * sine;
    rotation[3 * k + 1] = y * cosine - x * sine;
  }
}

GELENK_INLINE void SlideAlongZ(LaneNumbers* record, int part,
                               const Pack* rotation, Pack* origin) {
  const Pack way = Get(record, kAngle, part);
  for (int k = 0; k < 3; ++k) {
    Put(record, kAxis + k, part, rotation[3 * k + 2]);
    origin[k] += way * rotation[3 * k + 2];
  }
}

GELENK_INLINE void TurnByQuaternion(const ChainStep& step, LaneNumbers* record,
                                    int part, Pack* rotation,
                                    const Pack* origin) {
  Pack q[4], motion[9], turned[9];
  for (int k = 0; k < 4; ++k) q[k] = Get(record, kQuaternion + k, part);
  MatrixFromQuaternion(q, motion);
  Multiply(rotation, motion, turned);
  for (int k = 0; k < 9; ++k) rotation[k] = turned[k];
  if (step.limits_rotation) {
    // The axes in which the limits are a box.
    Pack basis[9];
    for (int k = 0; k < 9; ++k) basis[k] = Get(record, kBasis + k, part);
    Multiply(rotation, basis, turned);
  }
  for (int k = 0; k < 9; ++k) Put(record, kAxes + k, part, turned[k]);
  for (int k = 0; k < 3; ++k) Put(record, kCenter + k, part, origin[k]);
}

// Each segment in the frame that it starts from. False when an angle is too
// large for the vectorised sine.
template <bool kAnyAngle>
inline bool MoveSegments(ChainState& state) {
  Pack largest_angle = {};
  for (int part = 0; part < state.part_end; part += kWidth) {
    Pack rotation[9], origin[3];
    for (int k = 0; k < 9; ++k) {
      rotation[k] = Get(state.chain.steps[0].rotation, k, part);
    }
    for (int k = 0; k < 3; ++k) {
      origin[k] = Get(state.chain.steps[0].translation, k, part);
    }
    for (int s = 0; s < state.chain.step_count; ++s) {
      const ChainStep& step = state.chain.steps[s];
      LaneNumbers* record = state.RecordOf(step);
      if (s > 0) ToRest(step, part, rotation, origin);
      if (step.type == NodeType::kRevolute) {
        const Pack angle = Get(record, kAngle, part);
        largest_angle = Vector::Max(largest_angle, Vector::Abs(angle));
        TurnAboutZ<kAnyAngle>(angle, record, part, rotation, origin);
      } else if (step.type == NodeType::kPrismatic) {
        SlideAlongZ(record, part, rotation, origin);
      } else {
        TurnByQuaternion(step, record, part, rotation, origin);
      }
    }
    for (int k = 0; k < 9; ++k)
      Put(state.segment_rotation, k, part, rotation[k]);
    for (int k = 0; k < 3; ++k) Put(state.segment_end, k, part, origin[k]);
  }
  return Vector::Largest(largest_angle) <= kLargestAngle;
}

// Where each segment starts in the world, and the tip and the error as each
// segment sees them.
inline double JoinSegments(ChainState& state) {
  // A frame in columns of four rows, so many rows of all lanes at a time.
  double end[4];
  for (int row = 0; row < 4; row += kRows) {
    Rows c[4] = {};
    for (int k = 0; k < kRows && row + k < 3; ++k) {
      for (int j = 0; j < 3; ++j) {
        c[j][k] = state.settings.base_rotation[3 * (row + k) + j];
      }
      c[3][k] = state.settings.base_translation[row + k];
    }
    for (int lane = 0; lane < state.chain.lane_count; ++lane) {
      for (int k = 0; k < kRows && row + k < 3; ++k) {
        for (int j = 0; j < 3; ++j) {
          state.base_rotation[3 * (row + k) + j][lane] = c[j][k];
        }
        state.base[row + k][lane] = c[3][k];
      }
      Rows next[3];
      for (int j = 0; j < 3; ++j) {
        next[j] = c[0] * state.segment_rotation[j][lane] +
                  c[1] * state.segment_rotation[3 + j][lane] +
                  c[2] * state.segment_rotation[6 + j][lane];
      }
      c[3] += c[0] * state.segment_end[0][lane] +
              c[1] * state.segment_end[1][lane] +
              c[2] * state.segment_end[2][lane];
      for (int j = 0; j < 3; ++j) c[j] = next[j];
    }
    const double* t = state.chain.last_from_tip;
    c[3] += c[0] * t[0] + c[1] * t[1] + c[2] * t[2];
    for (int k = 0; k < kRows; ++k) end[row + k] = c[3][k];
  }
  double energy = 0;
  *state.work.position_error2 = 0;
  for (int i = 0; i < 3; ++i) {
    state.tip[i] = end[i];
    state.error[i] = state.target.world_translation[i] - end[i];
    *state.work.position_error2 +=
        state.target.row_counts[i] * state.error[i] * state.error[i];
    state.error[i] *= state.target.row_scale[i];
    energy += 0.5 * state.error[i] * state.error[i];
  }
  return energy;
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_CHAIN_FORWARD_H_
