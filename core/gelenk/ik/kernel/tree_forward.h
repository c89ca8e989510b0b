// Forward kinematics of a tree: the frames of its nodes, and the axes in which
// they move.
//
// For the kernels only, see base/kernel/inline.h.
#ifndef GELENK_IK_KERNEL_TREE_FORWARD_H_
#define GELENK_IK_KERNEL_TREE_FORWARD_H_

#include "gelenk/base/kernel/inline.h"
#include "gelenk/base/kernel/scalar.h"
#include "gelenk/base/kernel/sine.h"
#include "gelenk/ik/kernel/rotation_bounds.h"
#include "gelenk/ik/kernel/spatial_math.h"
#include "gelenk/ik/kernel/tree_layout.h"
#include "gelenk/ik/kernel/tree_state.h"

namespace gelenk::kernel::GELENK_KERNEL_LEVEL {
namespace {

GELENK_INLINE void TurnAboutZ(const double* a, double angle, double* out) {
  double s, c;
  SineCosine(angle, &s, &c);
  for (int i = 0; i < 3; ++i) {
    const double x = a[3 * i], y = a[3 * i + 1];
    out[3 * i] = x * c + y * s;
    out[3 * i + 1] = y * c - x * s;
    out[3 * i + 2] = a[3 * i + 2];
  }
}

// Column `column` of rotation `m` as a world axis.
GELENK_INLINE void StoreAxis(const double* m, int column, double* axis) {
  for (int i = 0; i < 3; ++i) axis[i] = m[3 * i + column];
}

// A rotation by quaternion `q`; its axes are the body's, or where it touches
// its limits those in which the limits are a box.
GELENK_INLINE void Turn(const TreeState& state, int i, const Node& node,
                        const double* rest, const double* q, double* rotation,
                        double* axis) {
  double motion[9];
  MatrixFromQuaternion(q, motion);
  Multiply(rest, motion, rotation);
  state.work.touched[i] = 0;
  if (node.limits_rotation && !IsWellInside(state.tree.rotation_limits[i], q)) {
    double* basis = state.work.body_bases + 9 * i;
    state.work.touched[i] =
        TouchRotationLimit(state.tree.rotation_limits[i], q, basis);
    if (state.work.touched[i] != 0) {
      double turned[9];
      Multiply(rotation, basis, turned);
      for (int k = 0; k < 3; ++k) StoreAxis(turned, k, axis + 3 * k);
      return;
    }
  }
  for (int k = 0; k < 3; ++k) StoreAxis(rotation, k, axis + 3 * k);
}

GELENK_INLINE void MoveNode(const TreeState& state, int i, const Node& node,
                            const double* rest, double* translation) {
  double* rotation = state.work.node_rotation + 9 * i;
  double* axis = state.work.axes + 3 * node.axis;
  const double* q = state.q + node.position;
  switch (node.type) {
    case NodeType::kRevolute:
      StoreAxis(rest, 2, axis);
      TurnAboutZ(rest, node.multiplier * q[0] + node.offset, rotation);
      break;
    case NodeType::kPrismatic: {
      StoreAxis(rest, 2, axis);
      const double d = node.multiplier * q[0] + node.offset;
      for (int k = 0; k < 3; ++k) translation[k] += d * axis[k];
      Copy(rest, rotation, 9);
      break;
    }
    case NodeType::kSpherical:
      Turn(state, i, node, rest, q, rotation, axis);
      break;
    case NodeType::kPlanar:
      for (int k = 0; k < 3; ++k) StoreAxis(rest, k, axis + 3 * k);
      for (int k = 0; k < 3; ++k) {
        translation[k] += q[0] * axis[k] + q[1] * axis[3 + k];
      }
      TurnAboutZ(rest, q[2], rotation);
      break;
    case NodeType::kFree:
      for (int k = 0; k < 3; ++k) StoreAxis(rest, k, axis + 3 * k);
      for (int k = 0; k < 3; ++k) {
        translation[k] +=
            q[0] * axis[k] + q[1] * axis[3 + k] + q[2] * axis[6 + k];
      }
      Turn(state, i, node, rest, q + 3, rotation, axis + 9);
      break;
  }
}

// Where all nodes and the axes of all columns are in the world, parents first.
inline void ForwardPass(const TreeState& state) {
  for (int i = 0; i < state.tree.node_count; ++i) {
    const Node& node = state.tree.nodes[i];
    const double* parent_rotation = state.RotationOf(node.parent);
    const double* parent_translation = state.TranslationOf(node.parent);
    double rest[9];
    const double* world_from_rest = parent_rotation;
    if (!node.offset_is_translation) {
      Multiply(parent_rotation, node.parent_from_rest_rotation, rest);
      world_from_rest = rest;
    }
    double* translation = state.work.node_translation + 3 * i;
    Transform(parent_rotation, parent_translation,
              node.parent_from_rest_translation, translation);
    MoveNode(state, i, node, world_from_rest, translation);
  }
}

}  // namespace
}  // namespace gelenk::kernel::GELENK_KERNEL_LEVEL

#endif  // GELENK_IK_KERNEL_TREE_FORWARD_H_
