// Which joints are at the end of their range.
#ifndef GELENK_IK_ON_LIMIT_H_
#define GELENK_IK_ON_LIMIT_H_

#include "gelenk/skeleton/pose.h"

namespace gelenk {

// A coordinate this near to its bound is on it, rad or m.
inline constexpr double kOnBound = 1e-9;

// By its own limits, box, swing cone or twist range, or those of a joint that
// moves along.
bool IsOnLimit(const Skeleton& skeleton, int joint,
               const ConstVectorView& positions);

}  // namespace gelenk

#endif  // GELENK_IK_ON_LIMIT_H_
