// Robots to retarget onto: files bolt their root to the world.
#ifndef GELENK_RETARGET_FLOATING_BASE_H_
#define GELENK_RETARGET_FLOATING_BASE_H_

#include <memory>

#include "absl/status/statusor.h"
#include "gelenk/skeleton/skeleton.h"

namespace gelenk {

// The same skeleton with a root that is free, where it was fixed; else itself.
// Ids stay; positions get the root's seven numbers in front. Errors: none that
// a valid skeleton can cause; passed on.
absl::StatusOr<std::shared_ptr<const Skeleton>> WithFloatingBase(
    std::shared_ptr<const Skeleton> skeleton);

}  // namespace gelenk

#endif  // GELENK_RETARGET_FLOATING_BASE_H_
