// How large loops of core run on several threads: core starts none, whoever
// calls it may lend it some.
#ifndef GELENK_BASE_PARALLEL_FOR_H_
#define GELENK_BASE_PARALLEL_FOR_H_

#include <functional>

#include "absl/functional/function_ref.h"

namespace gelenk {

// Runs part(0) .. part(count - 1), each once, in any order, on any threads, and
// returns when all have run. Parts are independent of each other: what they
// make does not depend on who runs them.
using ParallelFor =
    std::function<void(int count, absl::FunctionRef<void(int)> part)>;

}  // namespace gelenk

#endif  // GELENK_BASE_PARALLEL_FOR_H_
