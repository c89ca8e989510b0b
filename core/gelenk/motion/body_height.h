// How tall a body is, however it stands.
#ifndef GELENK_MOTION_BODY_HEIGHT_H_
#define GELENK_MOTION_BODY_HEIGHT_H_

#include <optional>

#include "gelenk/motion/body_parts.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// Length of the bones from the left foot to the top of the head, in the
// skeleton's unit. Unset unless `body` is complete. Cost: linear.
std::optional<double> BodyHeight(const Skeleton& skeleton,
                                 const BodyParts& body);

}  // namespace gelenk

#endif  // GELENK_MOTION_BODY_HEIGHT_H_
