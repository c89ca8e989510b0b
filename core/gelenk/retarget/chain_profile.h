// Orientations along a spine or neck, given to one of another joint count.
//
// The orientation of a chain runs from that of the joint below it (at 0) to
// that of its end (at 1), slerped between its joints by the length of the
// bones.
#ifndef GELENK_RETARGET_CHAIN_PROFILE_H_
#define GELENK_RETARGET_CHAIN_PROFILE_H_

#include <Eigen/Geometry>
#include <vector>

#include "absl/types/span.h"

namespace gelenk {

// Where to look between two joints of the source: 0 is what the chain stands
// on, k its joint k - 1.
struct ChainPlace {
  int from = 0;
  int to = 0;
  double part = 0;
};

// The place at `fraction` of a chain whose joints are at `fractions`,
// ascending.
ChainPlace PlaceOnChain(absl::Span<const double> fractions, double fraction);

// Allocates nothing.
Eigen::Quaterniond OrientationAt(const ChainPlace& place,
                                 const Eigen::Quaterniond& below,
                                 absl::Span<const Eigen::Quaterniond> chain,
                                 const Eigen::Quaterniond& end);

}  // namespace gelenk

#endif  // GELENK_RETARGET_CHAIN_PROFILE_H_
