// Guesses what a BVH file does not say: how long its unit is and which way is
// up. Both come from the body in it.
#ifndef GELENK_FORMATS_BVH_BODY_H_
#define GELENK_FORMATS_BVH_BODY_H_

#include <Eigen/Core>
#include <string>

#include "gelenk/formats/bvh_document.h"
#include "gelenk/formats/bvh_mapping.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// A guess and the sentence that tells the user.
struct UnitGuess {
  double unit_m = 0.01;
  std::string reason;
};

// `skeleton` has lengths in the file's unit. The height of a body is that of
// its bones from the foot to the top of the head, whatever the pose. Anything
// else is measured in the clip's first frame, from the ground if it is above,
// and taken for m, cm or mm.
UnitGuess GuessUnit(const BvhDocument& document, const Skeleton& skeleton,
                    const BvhMapping& mapping);

struct UpGuess {
  Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  // Empty when up is +Y and nothing speaks against it.
  std::string reason;
};

// The axis along which the head is above the feet, on average over the clip;
// +Y without frames or without a body.
UpGuess GuessUp(const BvhDocument& document, const Skeleton& skeleton,
                const BvhMapping& mapping);

}  // namespace gelenk

#endif  // GELENK_FORMATS_BVH_BODY_H_
