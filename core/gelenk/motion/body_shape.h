// Finds a body's limbs in a skeleton whose names say nothing.
//
// A body has two pairs of chains whose bones have the same lengths left and
// right. The pair that meets nearer to the root are the legs, the other the
// arms; the head ends the longest other chain above where the arms meet.
#ifndef GELENK_MOTION_BODY_SHAPE_H_
#define GELENK_MOTION_BODY_SHAPE_H_

#include "gelenk/motion/body_parts.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// The deepest joint that both hang from; `a` and `b` are joints.
int CommonAncestor(const Skeleton& skeleton, int a, int b);

// Parts that cannot be told are -1; without two pairs of chains all are.
// Sides come from the names along the chains, or else from the direction in
// which the feet point in the rest pose.
BodyParts FindBodyPartsByShape(const Skeleton& skeleton);

// The head alone, when the hands are known.
int FindHeadByShape(const Skeleton& skeleton, int left_hand, int right_hand);

}  // namespace gelenk

#endif  // GELENK_MOTION_BODY_SHAPE_H_
